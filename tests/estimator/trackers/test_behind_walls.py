"""Who searches a room is ranged from the corridor through its wall, now this and now that too long."""

import math

import numpy as np
import pytest

from estimator.measurements import AnyReading, Displacement, Node, Range
from estimator.simulate.base import TrueTrack
from tests.estimator.trackers.shown import followed, inside

SECONDS, IN_S, SETTLED_S = 150, 40, 60
"""He walks to and fro in the corridor, is in at the door from then on, and goes round in the room."""
CRUMBS_M = {"b1": (0.0, 0.0), "b2": (8.0, -1.0), "b3": (16.0, 0.0), "b4": (24.0, -1.0)}
SEEDS = range(8)


def search(seed: int, wall_m: float) -> tuple[list[AnyReading], TrueTrack]:
    """Readings of a search, and where he is, behind a wall that adds so much to ranges in the mean."""
    rng = np.random.default_rng(seed)
    t_s = np.arange(SECONDS + 1.0)
    true_m = np.array([_place(t) for t in t_s.tolist()])
    readings: list[AnyReading] = [
        Node(t=0.0, node="ff1", role="responder", position_m=(*_place(0.0), 0.0), heading_rad=0.0)
    ]
    readings += [
        Node(t=0.0, node=name, role="breadcrumb", position_m=(*at_m, 0.0), sigma_m=0.1)
        for name, at_m in CRUMBS_M.items()
    ]
    for second in range(1, SECONDS + 1):
        gone_m = true_m[second] - true_m[second - 1] + rng.normal(0.0, 0.03, 2)
        readings.append(
            Displacement(t=float(second), node="ff1", delta_m=(*gone_m.tolist(), 0.0), heading_rad=0.0)
        )
        for name, at_m in CRUMBS_M.items():
            excess_m = wall_m * rng.exponential() if second > IN_S else 0.0
            off_m = excess_m + rng.normal(0.0, 0.1)
            range_m = math.dist(true_m[second], at_m) + off_m
            readings.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
    flat = np.column_stack([true_m, np.zeros(len(t_s))])
    return readings, TrueTrack(t_s, flat, np.zeros(len(t_s), dtype=np.int64), np.zeros(len(t_s)))


def _place(t: float) -> tuple[float, float]:
    if t <= IN_S:
        return 12.0 - abs(t - 20.0) * 0.6, 0.5
    round_rad = 0.1 * (t - IN_S)
    return 2.5 * math.sin(round_rad), 4.0 - 2.5 * math.cos(round_rad) + min(t - IN_S, 2.0) * 0.5 - 1.0


@pytest.mark.parametrize(("wall_m", "off_m", "held"), [(0.4, 0.35, 0.75), (0.0, 0.12, 0.95)])
def test_who_is_behind_a_wall_is_shown_where_he_is_and_no_surer(
    wall_m: float, off_m: float, held: float
) -> None:
    """With ranges taken for what they are he is pushed out of the house by 0.45 m, and inside for 12 %."""
    shares, errors_m = [], []
    for seed in SEEDS:
        readings, true = search(seed, wall_m)
        points = {"ff1": [p for p in followed(readings, ["ff1"], SECONDS)["ff1"] if p.t > SETTLED_S]}
        at_m = true.at(np.array([p.t for p in points["ff1"]]))
        shown_m = np.array([p.position_m for p in points["ff1"]])
        shares.append(inside(points, {"ff1": true}))
        errors_m.append(np.hypot(*(shown_m - at_m)[:, :2].T).mean())
    assert np.mean(errors_m) < off_m
    assert np.mean(shares) > held
