"""What the scenarios round paper A's rectangle share: two walkers, one of them laying breadcrumbs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.measurements import AnyReading
from estimator.simulate.base import TrueTrack
from estimator.simulate.breadcrumbs import Dropped, drop_at
from estimator.simulate.paper_a import CORNERS_M, DROPS_M
from estimator.simulate.radio import calibrated
from estimator.simulate.team import (
    TYPICAL_UWB,
    Kit,
    base_track,
    introduce,
    introduce_base,
    introduce_dropped,
    measured,
    radios_of,
)
from estimator.simulate.walking import Leg, walk

LAPS = 4
FOLLOWS_S = {"ff1": 0.0, "ff2": 12.0}
END_S = 440.0


@dataclass(frozen=True, slots=True)
class Walked:
    """Who walks, and what lies on the way.

    Attributes:
        tracks: of both walkers and the base.
        crumbs: the six breadcrumbs of paper A.
    """

    tracks: dict[str, TrueTrack]
    crumbs: list[Dropped]


def walked(rng: np.random.Generator) -> Walked:
    """Both walk the rectangle four times at 1 m/s, ff2 12 s behind ff1, who drops the breadcrumbs."""
    legs = [Leg(corner, 1.0) for corner in CORNERS_M] * LAPS
    tracks = {n: walk((0.0, 0.0, 0.0), legs, (), END_S, stand_s=after) for n, after in FOLLOWS_S.items()}
    crumbs = [drop_at(f"b{i + 1}", "ff1", tracks["ff1"], metres, rng) for i, metres in enumerate(DROPS_M)]
    return Walked(tracks | {"base": base_track(END_S)}, crumbs)


def sensed(
    tracks: Mapping[str, TrueTrack],
    crumbs: Sequence[Dropped],
    off_s: Mapping[str, float],
    rng: np.random.Generator,
) -> list[AnyReading]:
    """The introductions, and what both walkers measure; `off_s`: when a breadcrumb dies (s)."""
    radios = radios_of(tracks, crumbs, off_s)
    readings: list[AnyReading] = [
        introduce_base(),
        *(introduce(node, tracks[node], rng) for node in FOLLOWS_S),
    ]
    readings += introduce_dropped(crumbs)
    kit = Kit(uwb=calibrated(TYPICAL_UWB, rng), altitude_sigma_m=None)
    for node in FOLLOWS_S:
        readings += measured(node, radios, END_S, rng, kit)
    return readings
