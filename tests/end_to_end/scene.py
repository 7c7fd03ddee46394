"""Readings of a small incident: a base at the entry and crews around it."""

import itertools
import time
from collections.abc import Sequence
from typing import TypeAlias

from tests.running import Post, eventually

Reading: TypeAlias = dict[str, object]

LEVELS = [{"level": 0, "name": "Ground", "up_m": 0.0}, {"level": 1, "name": "First", "up_m": 3.0}]

_batches = itertools.count()


def base(t: float) -> Reading:
    """The base station at the entry, the origin of the map."""
    return {"kind": "node", "t": t, "node": "base", "role": "base", "position_m": [0.0, 0.0, 0.0]}


def responder(t: float, node: str, crew: str, at_m: Sequence[float], sigma_m: float = 0.5) -> Reading:
    """A responder who stands at a known place (east, north, up); its callsign is its name in capitals."""
    return {
        "kind": "node",
        "t": t,
        "node": node,
        "role": "responder",
        "callsign": node.upper(),
        "crew": crew,
        "position_m": [float(value) for value in at_m],
        "sigma_m": sigma_m,
        "heading_rad": 0.0,
        "heading_sigma_rad": 0.01,
    }


def step(t: float, node: str, delta_m: Sequence[float]) -> Reading:
    """A displacement that the responder's unit has measured."""
    return {"kind": "displacement", "t": t, "node": node, "delta_m": [float(value) for value in delta_m]}


def dropped(t: float, node: str, by: str) -> Reading:
    """A breadcrumb that a responder has dropped."""
    return {"kind": "drop", "t": t, "node": node, "by": by}


def alarm(
    t: float, node: str, kind: str = "mayday", state: str = "raised", text: str | None = None
) -> Reading:
    """An alarm of a responder."""
    said = {} if text is None else {"text": text}
    return {"kind": "alarm", "t": t, "node": node, "alarm": kind, "state": state, **said}


def heard(post: Post, incident: str, *readings: Reading) -> None:
    """Post readings and wait until the estimator has folded them."""
    answer = post.telemetry(incident, f"batch-{next(_batches)}", readings)
    assert answer["rejected"] == []
    seq = answer["seq"]
    assert isinstance(seq, int)
    post.frame(incident, min_seq=seq)


def one_inside(post: Post, settings: dict[str, float] | None = None) -> str:
    """A live incident with a base and one responder, who has just entered; its identifier."""
    incident, now = post.open_incident(clock="live", settings=settings or {}), time.time()
    heard(post, incident, base(now), responder(now, "walker", "A", [2, 2, 0]))
    return incident


def recorded(post: Post, incident: str, t: float) -> None:
    """Wait until the picture of a second of incident time is recorded, so that it can be replayed."""

    def last_t() -> float | None:
        answer = post.http.get(f"/incidents/{incident}").json()["last_t"]
        return None if answer is None else float(answer)

    eventually(lambda: (newest := last_t()) is not None and newest >= t)


def two_on_two_storeys(post: Post, t: float, name: str = "Office") -> str:
    """An incident of eight seconds: ff1 walks on the ground floor, ff2 stands on the first."""
    incident = post.open_incident(name, levels=LEVELS)
    heard(
        post,
        incident,
        base(t),
        responder(t, "ff1", "A", [2, 2, 0], sigma_m=0.2),
        responder(t, "ff2", "A", [4, 2, 3], sigma_m=0.2),
    )
    for second in range(1, 9):
        heard(post, incident, step(t + second, "ff1", [0.2, 0, 0]))
    recorded(post, incident, t + 8)
    return incident
