"""A crew inside is ranged by vehicles in the street through its building's shell: all too long alike."""

import math

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import Altitude, AnyReading, Displacement, Node, Range
from estimator.simulate.base import TrueTrack
from estimator.trackers import smoother
from estimator.trackers.base import TrackerSettings
from tests.estimator.trackers.shown import followed, inside

SECONDS, IN_S, ROUND_RAD = 180, 50, 0.08
"""They wait in the street, are in at the door from then on, and go round inside."""
VEHICLES_M = {"engine": (-14.0, -12.0, 1.5), "ladder": (4.0, -14.0, 1.5), "tanker": (20.0, 24.0, 1.5)}
SHELL_M = {"engine": 0.4, "ladder": 0.5, "tanker": 0.6}
"""What a thick shell adds, always: no range scatters by it."""
SEEDS = range(6)


def _place(number: int, t: float) -> tuple[float, float]:
    if t <= IN_S:
        return 3.0 * number + 2.0 * math.sin(0.2 * t), -6.0 + 0.5 * math.cos(0.2 * t)
    turned = ROUND_RAD * (t - IN_S) + number
    share = min((t - IN_S) / 10.0, 1.0)
    waited = _place(number, float(IN_S))
    there = 6.0 * math.sin(turned) + 4.0, 8.0 - 6.0 * math.cos(turned)
    return waited[0] + share * (there[0] - waited[0]), waited[1] + share * (there[1] - waited[1])


def entry(seed: int, share: float) -> tuple[list[AnyReading], dict[str, TrueTrack]]:
    """Readings of two of a crew, and where they are, behind a shell that adds a share of `SHELL_M`."""
    rng = np.random.default_rng(seed)
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=at_m, sigma_m=0.1)
        for name, at_m in VEHICLES_M.items()
    ]
    t_s, tracks = np.arange(SECONDS + 1.0), {}
    for number in (1, 2):
        true_m: Array = np.array([(*_place(number, t), 0.0) for t in t_s.tolist()])
        name = f"ff{number}"
        tracks[name] = TrueTrack(t_s, true_m, np.zeros(len(t_s), dtype=np.int64), np.zeros(len(t_s)))
        begins_m = (float(true_m[0, 0]), float(true_m[0, 1]), 0.0)
        readings.append(
            Node(t=0.0, node=name, role="responder", crew="E7", position_m=begins_m, heading_sigma_rad=0.05)
        )
        for second in range(1, SECONDS + 1):
            gone_m = (true_m[second] - true_m[second - 1])[:2] + rng.normal(0.0, 0.03, 2)
            move_m = (*gone_m.tolist(), 0.0)
            t = float(second)
            readings.append(Displacement(t=t, from_t=t - 1.0, node=name, delta_m=move_m))
            readings.append(Altitude(t=t, node=name, up_m=float(rng.normal(0.0, 0.3)), sigma_m=0.3))
            for vehicle, at_m in VEHICLES_M.items():
                shell_m = share * SHELL_M[vehicle] if second > IN_S else 0.0
                range_m = math.dist(true_m[second], at_m) + shell_m + rng.normal(0.0, 0.1)
                readings.append(Range(t=t, a=name, b=vehicle, range_m=range_m, technology="uwb"))
    return sorted(readings, key=lambda reading: reading.until_t), tracks


@pytest.mark.parametrize("share", [1.0, 0.0])
def test_a_crew_is_inside_its_ellipses_behind_a_shell_and_in_sight(share: float) -> None:
    """With ranges taken for what they are, behind a shell 35 % live, and nobody looking back."""
    live, back = [], []
    for seed in SEEDS:
        readings, tracks = entry(seed, share)
        live.append(inside(followed(readings, list(tracks), SECONDS), tracks))
        back.append(inside(smoother("kirchhoff", TrackerSettings()).smooth(readings), tracks))
    assert min(np.mean(live), np.mean(back)) > 0.85
