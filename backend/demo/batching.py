"""Readings of a scenario as the batches that gateways post."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import msgspec

from estimator.measurements import AnyReading, Displacement
from estimator.simulate import Report

WINDOW_S = 0.5
"""A gateway gathers what its crew's radios send for this long, then posts it."""


@dataclass(frozen=True, slots=True)
class Batch:
    """What a gateway posts at once.

    Attributes:
        due_s: when it is posted, in the scenario's time (s).
        readings: in order of arrival at the gateway, `t` in the scenario's time.
    """

    due_s: float
    readings: tuple[AnyReading, ...]


def gateways_of(reports: Sequence[Report]) -> list[str]:
    """The gateways that post, sorted."""
    return sorted({report.gateway for report in reports})


def batches_of(reports: Sequence[Report], gateway: str) -> Iterator[Batch]:
    """The batches of one gateway, in order: each holds what came to it in `WINDOW_S`.

    Args:
        reports: of all gateways, in order of posting.
        gateway: which one.
    """
    gathered: list[AnyReading] = []
    due_s = WINDOW_S
    for report in reports:
        if report.gateway != gateway:
            continue
        if report.sent_s >= due_s:
            if gathered:
                yield Batch(due_s, tuple(gathered))
            gathered = []
            due_s = (report.sent_s // WINDOW_S + 1) * WINDOW_S
        gathered.append(report.reading)
    if gathered:
        yield Batch(due_s, tuple(gathered))


def body_of(batch: Batch, gateway: str, name: str, start: float) -> bytes:
    """The JSON body that posts `batch`.

    Args:
        batch: what is posted.
        gateway: by whom.
        name: its idempotency key.
        start: when the scenario began, Unix seconds.
    """
    return msgspec.json.encode(
        {
            "gateway": gateway,
            "batch": name,
            "sent": round(start + batch.due_s, 3),
            "readings": [_shifted(reading, start) for reading in batch.readings],
        }
    )


def _shifted(reading: AnyReading, start: float) -> AnyReading:
    t = round(start + reading.t, 3)
    if isinstance(reading, Displacement) and reading.from_t is not None:
        return msgspec.structs.replace(reading, t=t, from_t=round(start + reading.from_t, 3))
    return msgspec.structs.replace(reading, t=t)
