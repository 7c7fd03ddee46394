"""Breadcrumbs: dropped on the way in, and kicked later."""

from dataclasses import dataclass, replace

import numpy as np

from estimator.simulate.base import TrueTrack, static_track

BESIDE_M = 0.3
SPACING_M = 12.0, 15.0
"""Of the way of who drops them, at random between these."""
KICKED_M = 4.0


@dataclass(frozen=True, slots=True)
class Dropped:
    """A breadcrumb on the floor.

    Attributes:
        node: its name.
        by: who dropped it.
        t_s: when (s).
        truth: where it lies.
    """

    node: str
    by: str
    t_s: float
    truth: TrueTrack


def drop_along(
    prefix: str,
    by: str,
    truth: TrueTrack,
    rng: np.random.Generator,
    until_s: float,
) -> list[Dropped]:
    """A breadcrumb each `SPACING_M` of the way that `by` walks until `until_s`, named `prefix` and number."""
    way_m = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(truth.position_m, axis=0), axis=1))])
    dropped: list[Dropped] = []
    at_m = float(rng.uniform(*SPACING_M)) / 2
    while True:
        tick = int(np.searchsorted(way_m, at_m))
        if tick >= len(way_m) or truth.t_s[tick] > until_s:
            return dropped
        dropped.append(
            drop_at(f"{prefix}{len(dropped) + 1}", by, truth, round(float(truth.t_s[tick]), 3), rng)
        )
        at_m += float(rng.uniform(*SPACING_M))


def drop_at(node: str, by: str, truth: TrueTrack, t_s: float, rng: np.random.Generator) -> Dropped:
    """The breadcrumb `node` that lies 0.3 m beside the foot of `by` from `t_s` on."""
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    beside = BESIDE_M * np.array([np.cos(angle), np.sin(angle), 0.0])
    at = np.array([t_s])
    place = static_track(
        truth.at(at)[0] + beside, int(truth.level_at(at)[0]), t_s, max(t_s, float(truth.t_s[-1]))
    )
    return Dropped(node, by, t_s, place)


def kicked(crumb: Dropped, t_s: float, rng: np.random.Generator) -> Dropped:
    """`crumb`, which slides `KICKED_M` east or west along the floor at `t_s`, within half a second."""
    slide = np.array([KICKED_M * (1.0 if rng.random() < 0.5 else -1.0), 0.0, 0.0])
    start, end = crumb.truth.position_m[0], crumb.truth.position_m[0] + slide
    moved = TrueTrack(
        np.array([crumb.t_s, t_s, t_s + 0.5, crumb.truth.t_s[-1]]),
        np.stack([start, start, end, end]),
        np.full(4, crumb.truth.level[0]),
        np.zeros(4),
    )
    return replace(crumb, truth=moved)
