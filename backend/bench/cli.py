"""The commands `firethread bench …`: each reads its options and prints its table."""

from pathlib import Path
from typing import Annotated

import typer

from backend.refusals import refusing

bench = typer.Typer(
    help="The project's own tables of speed and accuracy, each beside what it is compared with.",
    no_args_is_help=True,
)


@bench.command("ingest")
def bench_ingest() -> None:
    """Telemetry into the log, as a ratio to decoding and one fsync per 32 batches."""
    from backend.bench import ingest

    ingest.run()


@bench.command("replay")
def bench_replay() -> None:
    """Reading the log back, as a ratio to decoding in memory."""
    from backend.bench import replay

    replay.run()


@bench.command("fanout")
def bench_fanout() -> None:
    """Frames to a thousand sockets, as a ratio to a bare broadcaster."""
    from backend.bench import fanout

    fanout.run()


@bench.command("latency")
def bench_latency() -> None:
    """From a gateway's POST to the delta at a screen."""
    from backend.bench import latency

    latency.run()


@bench.command("accuracy")
def bench_accuracy(
    seeds: Annotated[int, typer.Option(min=1, help="So many of each scenario; the table has means.")] = 20,
    only: Annotated[
        list[str] | None, typer.Option(help="A scenario, a data set, or DATA_SET:RECORDING; once for each.")
    ] = None,
    trackers: Annotated[
        list[str] | None, typer.Option(help="A tracker, gtsam or least-squares; once for each.")
    ] = None,
    data: Annotated[Path, typer.Option(help="Folder of the data sets' folders.")] = Path("../shared/data"),
    html: Annotated[Path | None, typer.Option(help="Write a report with plots to this file.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="So many processes.")] = 1,
) -> None:
    """Errors of every tracker on every scenario and data set, beside GTSAM on the same readings."""
    from backend.bench.accuracy.run import Choice, run

    with refusing():
        run(Choice(seeds, only or (), trackers or (), data, html, jobs))


@bench.command("speed")
def bench_speed(
    only: Annotated[
        list[str] | None,
        typer.Option(
            help="same-graph, growth, size, real-time, smoothed, or a case of same-graph; once for each."
        ),
    ] = None,
    data: Annotated[Path, typer.Option(help="Folder of the data sets' folders.")] = Path("../shared/data"),
) -> None:
    """What a keyframe costs, beside GTSAM's iSAM2 on the same readings, and over hours, crews, real time."""
    from backend.bench.speed.run import run

    with refusing():
        run(only or (), data)


@bench.command("all")
def bench_all() -> None:
    """The tables of the service, one after the other: ingest, replay, fanout, latency."""
    for table in (bench_ingest, bench_replay, bench_fanout, bench_latency):
        table()
