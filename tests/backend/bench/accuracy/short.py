"""A minute round a square among three known radios: short enough for tests."""

import numpy as np

from estimator.measurements import AnyReading, Displacement, Node, Range, Rssi
from estimator.simulate import Report, Scenario, TrueTrack
from estimator.simulate.base import static_track

NAME = "short"
DURATION_S = 60
ANCHORS = {"base": (0.0, 0.0, 0.0), "a1": (20.0, -3.0, 0.0), "a2": (5.0, 22.0, 0.0)}
CORNERS = np.array([[2.0, 0.0], [17.0, 0.0], [17.0, 15.0], [2.0, 15.0], [2.0, 0.0]])


def true_track() -> TrueTrack:
    """Round the square at 1 m/s."""
    t_s = np.arange(DURATION_S + 1.0)
    places = np.column_stack([np.interp(t_s, np.arange(0.0, 61.0, 15.0), CORNERS[:, i]) for i in range(2)])
    position_m = np.column_stack([places, np.zeros(len(t_s))])
    return TrueTrack(t_s, position_m, np.zeros(len(t_s), dtype=np.int64), np.zeros(len(t_s)))


def build(seed: int) -> Scenario:
    """The scenario: displacements, ranges to the radios and RSSI of them, each second."""
    rng = np.random.default_rng(seed)
    truth = true_track()
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="base" if name == "base" else "anchor", position_m=place, sigma_m=0.05)
        for name, place in ANCHORS.items()
    ]
    start_m = (2.0, 0.0, 0.0)
    readings.append(Node(t=0.0, node="ff", role="responder", position_m=start_m, sigma_m=0.3))
    moved = np.diff(truth.position_m, axis=0) + rng.normal(0.0, 0.03, (DURATION_S, 3)) * [1.0, 1.0, 0.0]
    for second in range(1, DURATION_S + 1):
        east, north, _ = moved[second - 1].tolist()
        readings.append(Displacement(t=float(second), node="ff", delta_m=(east, north, 0.0)))
        for name, place in ANCHORS.items():
            distance_m = float(np.linalg.norm(truth.position_m[second] - place))
            measured_m = max(0.0, distance_m + float(rng.normal(0.0, 0.1)))
            readings.append(Range(t=float(second), a="ff", b=name, range_m=measured_m, technology="uwb"))
            dbm = -45.0 - 22.0 * float(np.log10(max(distance_m, 0.3))) + float(rng.normal(0.0, 4.0))
            readings.append(Rssi(t=float(second), a="ff", b=name, dbm=dbm))
    reports = tuple(Report(reading, "engine-1", reading.t + 0.1) for reading in readings)
    radios = {name: static_track(np.array(place), 0, 0.0, DURATION_S) for name, place in ANCHORS.items()}
    return Scenario(NAME, "A short walk", "recorded", (), reports, radios | {"ff": truth}, float(DURATION_S))
