"""The command `firethread`: each function reads its options and calls the house."""

import os

# Before anything imports numpy: with more threads sums depend on chance, and the web process starves.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from backend.bench.cli import bench
from backend.errors import in_reach
from backend.log.incident import Clock
from backend.refusals import refuse, refusing
from backend.reports import to_standard_error
from backend.settings import DATABASE_VARIABLE, LINK_TOKEN_VARIABLE, Settings, host_and_port

app = typer.Typer(
    help="Where every firefighter is inside a burning building, how sure that is, and the way out.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.add_typer(bench, name="bench")


@app.callback()
def every_command() -> None:
    """Where every firefighter is inside a burning building, how sure that is, and the way out."""
    to_standard_error()


Data = Annotated[Path, typer.Option("--data", help="Folder of the SQLite database and the access token.")]
Database = Annotated[
    str | None,
    typer.Option(
        "--database", envvar=DATABASE_VARIABLE, help="URL of a Postgres database, instead of SQLite."
    ),
]
Supervised = Annotated[bool, typer.Option("--supervised", hidden=True)]


@app.command()
def serve(
    data: Data = Path(".data"),
    database: Database = None,
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port to listen on; 0 picks a free one.")
    ] = 8000,
    open_access: Annotated[
        bool, typer.Option("--open", help="Ask nobody for the access token; loopback addresses only.")
    ] = False,
    worker: Annotated[bool, typer.Option(help="Run an estimator worker beside the web process.")] = True,
    link: Annotated[
        str, typer.Option(help="HOST:PORT where workers connect; port 0 picks a free one.")
    ] = "127.0.0.1:0",
    demo: Annotated[
        bool, typer.Option("--demo", help="Play the demo incident through the public API.")
    ] = False,
) -> None:
    """Serve the API and the screen."""
    from backend import serving

    with refusing():
        serving.serve(
            Settings(
                data=data,
                database=database,
                host=host,
                port=port,
                open_access=open_access,
                worker=worker,
                link=link,
                demo=demo,
            )
        )


@app.command()
def worker(
    database: Database = None,
    data: Data = Path(".data"),
    link: Annotated[
        str | None, typer.Option(help="HOST:PORT of the web process; without it the log is polled.")
    ] = None,
    holder: Annotated[
        str, typer.Option(help="Name under which leases are held; one per worker, the same after a restart.")
    ] = "worker",
    supervised: Supervised = False,
) -> None:
    """Follow the logs of active incidents and estimate positions."""
    from backend.log.engine import understood
    from backend.supervision import end_with_parent

    token = os.environ.get(LINK_TOKEN_VARIABLE, "")
    if link is not None and not token:
        refuse(f"--link needs the token that web process and worker share, in {LINK_TOKEN_VARIABLE}")
    settings = Settings(data=data, database=database)
    with refusing():
        understood(settings.database_url)
        address = None if link is None else host_and_port(link)
    from backend.tracking.worker import run_worker

    if supervised:
        end_with_parent()
    run_worker(settings.database_url, address, token, holder, settings.shown_hz)


@app.command()
def demo(
    url: Annotated[str, typer.Option(help="Address of the server.")] = "http://127.0.0.1:8000",
    data: Annotated[
        Path | None,
        typer.Option("--data", help="The server's folder, for its access token; not with --open."),
    ] = None,
    scenario: Annotated[str, typer.Option(help="Which simulated incident.")] = "office-fire",
    seed: Annotated[
        int, typer.Option(min=0, help="Of the first round; each further one takes the next.")
    ] = 1,
    speed: Annotated[float, typer.Option(help="How fast; other than 1 only on a recorded clock.")] = 1.0,
    once: Annotated[bool, typer.Option(help="One round only.")] = False,
    supervised: Supervised = False,
) -> None:
    """Play a simulated incident through the public API, as gateways would."""
    from backend.authentication import existing_token
    from backend.demo import play_until_stopped
    from backend.supervision import end_with_parent

    if supervised:
        end_with_parent()
    with refusing():
        token = None if data is None else existing_token(data)
        play_until_stopped(url, token, scenario, seed, speed, once)


@app.command("import")
def import_(
    file: Annotated[
        Path, typer.Argument(help="A recorded log, NDJSON; - is standard input.", allow_dash=True)
    ],
    incident: Annotated[str | None, typer.Option(help="Name of the incident that it becomes.")] = None,
    data: Data = Path(".data"),
    database: Database = None,
    clock: Annotated[
        Clock | None, typer.Option(help="recorded: its newest reading is now; live: the server's clock.")
    ] = None,
    level: Annotated[
        list[str] | None, typer.Option(help="A storey as NUMBER:NAME:HEIGHT_M; once for each.")
    ] = None,
    origin: Annotated[str | None, typer.Option(help="Local origin as LAT,LON,HEIGHT_M in WGS84.")] = None,
    setting: Annotated[
        list[str] | None, typer.Option(help="One as NAME=VALUE, such as tracker=paper-a; once for each.")
    ] = None,
) -> None:
    """Load a recorded log as a new incident: by what its first line says of it, and by what is given here."""
    from backend import recordings

    kept = Settings(data=data, database=database)
    with refusing():
        kept.make_folder()
        done = recordings.import_log(
            kept.database_url,
            incident,
            file,
            clock=clock,
            levels=None if level is None else [recordings.parse_level(text) for text in level],
            origin=None if origin is None else recordings.parse_origin(origin),
            settings=recordings.parse_settings(setting or ()),
        )
    typer.echo(
        f"incident {done.incident}: {done.batches} batches, {done.accepted} readings, "
        f"{done.rejected} set aside, {done.duplicates} batches twice in the file"
    )


@app.command()
def export(
    incident: Annotated[str, typer.Argument(help="Identifier or unique name.")],
    data: Data = Path(".data"),
    database: Database = None,
) -> None:
    """Write an incident's log, NDJSON, on standard output."""
    from backend import recordings

    with refusing():
        _write(recordings.export_log(Settings(data=data, database=database).database_url, incident))


@app.command()
def convert(
    name: Annotated[str, typer.Argument(help="The data set, such as plaza1.")],
    folder: Annotated[Path, typer.Argument(help="Its folder.")],
) -> None:
    """Write a public data set as a recorded log, NDJSON, on standard output."""
    from backend import recordings

    with refusing():
        _write(recordings.convert(name, folder))


def _write(lines: Iterable[bytes]) -> None:
    """Lines on standard output; a full disk under it is no defect of ours."""
    for line in lines:
        with in_reach("standard output"):
            sys.stdout.buffer.write(line)
    with in_reach("standard output"):
        sys.stdout.buffer.flush()


@app.command()
def openapi() -> None:
    """Write the OpenAPI document on standard output."""
    from backend.main import build_app
    from backend.serving import listen

    with TemporaryDirectory() as folder, listen("127.0.0.1", 0) as link:
        app = build_app(Settings(data=Path(folder)), token=None, link=link, link_token="")
        sys.stdout.write(json.dumps(app.openapi(), indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    app()
