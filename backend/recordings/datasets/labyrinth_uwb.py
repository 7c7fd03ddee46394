"""labyrinth_uwb: a small robot with wheel odometry, ranging to four UWB anchors around a labyrinth.

The anchors' places are in the data, and the stated variances of ranges are passed on. Where the robot starts
and what it faces is not in the data, and is not taken from the truth: it stands for its first two seconds, in
which the anchors tell its place; its heading is to be found. Heights are not given: all is in one plane.
"""

import math
from pathlib import Path

from backend.recordings.datasets.base import KNOWN_SIGMA_M, Row, words
from estimator.measurements import AnyReading, Displacement, Node, Range

NAME = "labyrinth_uwb"
RECORDINGS: tuple[str, ...] = ()
ROBOT = "robot"


def readings(folder: Path, recording: str | None = None) -> list[AnyReading]:
    """The readings of the data set in `folder`.

    Args:
        folder: where `Indoor_UWB_Input.txt` is.
        recording: there is but one.

    Raises:
        NotTheDataSet: the file is missing.
    """
    del recording
    table = list(words(folder / "Indoor_UWB_Input.txt"))
    ranged = [row for row in table if row.word(0) == "range2"]
    wheels = [row for row in table if row.word(0) == "odom2diff"]
    since = min(row.number(1) for row in table)
    introduced: list[AnyReading] = [
        Node(t=since, node=ROBOT, role="responder", callsign="Robot", heading_sigma_rad=math.pi)
    ]
    places = {_anchor(row): (row.number(4), row.number(5), 0.0) for row in ranged}
    introduced += [
        Node(t=since, node=name, role="anchor", position_m=place, sigma_m=KNOWN_SIGMA_M)
        for name, place in sorted(places.items())
    ]
    ranges = [
        Range(
            t=row.number(1),
            a=ROBOT,
            b=_anchor(row),
            range_m=row.number(2),
            sigma_m=math.sqrt(row.above_0(3)),
            technology="uwb",
        )
        for row in ranged
    ]
    return [*introduced, *_driven(wheels, since), *ranges]


def _anchor(row: Row) -> str:
    return f"anchor-{row.word(6)}"


def _driven(wheels: list[Row], since: float) -> list[AnyReading]:
    """Displacements in a frame whose x axis is where the robot faces at first.

    Yaw rate = (second velocity - first) / (2 · wheel base), as the authors' own library libRSF reads these
    columns (`PredictMotionDifferential2D`): the stated base is from the centre to a wheel.
    """
    driven: list[AnyReading] = []
    heading = 0.0
    for row in wheels:
        t, first, second, sideways = (row.number(column) for column in range(1, 5))
        base_m = row.above_0(5)
        span_s = t - since
        turn_rad = (second - first) / (2.0 * base_m) * span_s
        along = heading + turn_rad / 2.0
        heading += turn_rad
        ahead_m, left_m = (first + second) / 2.0 * span_s, sideways * span_s
        delta_m = (
            ahead_m * math.cos(along) - left_m * math.sin(along),
            ahead_m * math.sin(along) + left_m * math.cos(along),
            0.0,
        )
        driven.append(Displacement(t=t, node=ROBOT, delta_m=delta_m, from_t=since, heading_rad=heading))
        since = t
    return driven
