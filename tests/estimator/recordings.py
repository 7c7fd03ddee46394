"""Public recordings as readings, and their truth, for the tests of the estimator; the two never meet."""

import csv
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimator.estimate import NodeEstimate
from estimator.evaluate import Errors, errors, full_covariance
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.base import Tracker

Array = NDArray[np.float64]
AnyOf = Node | Displacement | Range


class Recording(NamedTuple):
    """Readings in order of epoch, and the true track of one node: t, east, north, up, n × 4."""

    readings: list[AnyOf]
    node: str
    truth: Array
    distance_m: float


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open() as lines:
        return list(csv.DictReader(line.lstrip("%") for line in lines))


def plaza1(folder: Path) -> Recording:
    """Robot with odometry and raw ranges to four unknown beacons; only its first pose is given."""
    truth = np.array([[float(v) for v in r.values()] for r in _rows(folder / "plaza1" / "groundtruth.csv")])
    first_t, heading = float(truth[0, 0]), float(truth[0, 3])
    readings: list[AnyOf] = [
        Node(
            t=first_t,
            node="robot",
            role="responder",
            position_m=(float(truth[0, 1]), float(truth[0, 2]), 0.0),
            sigma_m=0.05,
            heading_rad=heading,
            heading_sigma_rad=0.01,
        )
    ]
    ranges = _rows(folder / "plaza1" / "ranges.csv")
    beacons = sorted({r["beacon_id"] for r in ranges})
    readings += [Node(t=first_t, node=f"beacon{b}", role="beacon") for b in beacons]
    for row in _rows(folder / "plaza1" / "odometry.csv"):
        distance, turn = float(row["dist_m"]), float(row["dheading_rad"])
        halfway = heading + 0.5 * turn
        heading += turn
        delta = (distance * math.cos(halfway), distance * math.sin(halfway), 0.0)
        readings.append(Displacement(t=float(row["t_s"]), node="robot", delta_m=delta, heading_rad=heading))
    readings += [
        Range(
            t=float(r["t_s"]),
            a="robot",
            b=f"beacon{r['beacon_id']}",
            range_m=float(r["range_raw_m"]),
            technology="uwb",
        )
        for r in ranges
    ]
    readings.sort(key=lambda r: r.t)
    track = np.column_stack([truth[:, :3], np.zeros(len(truth))])
    way = float(np.hypot(np.diff(truth[:, 1]), np.diff(truth[:, 2])).sum())
    return Recording(readings, "robot", track, way)


def labyrinth(folder: Path) -> Recording:
    """Robot among four known UWB anchors, obstructed; wheel odometry, first pose not given."""
    readings: list[AnyOf] = []
    anchors: dict[str, tuple[float, float, float]] = {}
    heading, last = 0.0, 0.0
    lines = (folder / "labyrinth_uwb" / "Indoor_UWB_GT.txt").read_text().splitlines()
    track = np.array([[*map(float, line.split()[1:4]), 0.0] for line in lines])
    motion: list[AnyOf] = []
    for line in (folder / "labyrinth_uwb" / "Indoor_UWB_Input.txt").read_text().splitlines():
        kind, *words = line.split()
        v = [float(w) for w in words]
        if kind == "range2":
            anchors[f"a{int(v[5])}"] = (v[3], v[4], 0.0)
            sigma = math.sqrt(v[2])
            readings.append(
                Range(t=v[0], a="robot", b=f"a{int(v[5])}", range_m=v[1], sigma_m=sigma, technology="uwb")
            )
        else:
            duration = v[0] - last
            last = v[0]
            right, left, base = v[1], v[2], v[4]
            turn = (right - left) / base * duration
            length = 0.5 * (right + left) * duration
            delta = (length * math.cos(heading + turn / 2), length * math.sin(heading + turn / 2), 0.0)
            heading += turn
            motion.append(Displacement(t=v[0], node="robot", delta_m=delta, heading_rad=heading))
    start: list[AnyOf] = [
        Node(t=0.0, node=name, role="anchor", position_m=where, sigma_m=0.02)
        for name, where in anchors.items()
    ]
    everything = sorted([*start, *motion, *readings], key=lambda r: r.t)
    way = float(np.hypot(np.diff(track[:, 1]), np.diff(track[:, 2])).sum())
    return Recording(everything, "robot", track, way)


def hanyang(folder: Path, walk: str) -> Recording:
    """A walker without PDR among four known UWB anchors on a vehicle; only ranges."""
    readings: list[AnyOf] = []
    first = math.inf
    for anchor in ("A3", "A5", "A9", "A12"):
        rows = _rows(folder / "uwb_outdoor_hanyang" / f"{walk}_{anchor}.csv")
        east, north, up = (float(rows[0][f"field.{axis}"]) for axis in "xyz")
        t0 = float(rows[0]["time"]) * 1e-9
        first = min(first, t0)
        readings.append(Node(t=t0, node=anchor, role="anchor", position_m=(east, north, up), sigma_m=0.02))
        readings += [
            Range(
                t=float(r["time"]) * 1e-9,
                a="walker",
                b=anchor,
                range_m=float(r["field.distanceFromTag"]),
                technology="uwb",
            )
            for r in rows
        ]
    readings.append(Node(t=first, node="walker", role="responder"))
    readings.sort(key=lambda r: (r.t, not isinstance(r, Node)))
    truth = np.array(
        [
            [float(r["timestamp"]) * 1e-9, float(r["x"]), float(r["y"]), float(r["z"])]
            for r in _rows(folder / "uwb_outdoor_hanyang" / f"{walk}_trajectory.csv")
        ]
    )
    way = float(np.hypot(np.diff(truth[:, 1]), np.diff(truth[:, 2])).sum())
    return Recording(readings, "walker", truth, way)


def each_second(tracker: Tracker, readings: list[AnyOf], node: str) -> list[NodeEstimate]:
    """The node's estimate as it stood at each whole second, from readings up to then only."""
    shown: list[NodeEstimate] = []
    waiting: list[AnyOf] = []
    second = math.floor(readings[0].t) + 1
    for reading in readings:
        if reading.t > second:
            tracker.fold(waiting)
            waiting = []
            shown += [e for e in tracker.estimates() if e.node == node and e.position_m is not None]
            second = math.ceil(reading.t)
        waiting.append(reading)
    tracker.fold(waiting)
    return shown + [e for e in tracker.estimates() if e.node == node and e.position_m is not None]


def judged(shown: list[NodeEstimate], truth: Array, distance_m: float) -> Errors:
    """Errors of estimates against the truth interpolated to their epochs."""
    inside = [e for e in shown if truth[0, 0] <= e.t <= truth[-1, 0]]
    t = np.array([e.t for e in inside])
    true = np.column_stack([np.interp(t, truth[:, 0], truth[:, axis]) for axis in (1, 2, 3)])
    covariance = full_covariance(np.array([e.covariance_m2 for e in inside]))
    return errors(np.array([e.position_m for e in inside]), true, covariance, distance_m)
