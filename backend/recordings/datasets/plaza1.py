"""plaza1: a robot mower with odometry, and ranges to four beacons at unknown places.

`odometry.csv` holds the distance driven and the heading turned since the row before; `ranges.csv` raw ranges.
They are passed on raw: what is wrong with their scale is for the estimator to find. Of the truth one thing is
used, as the experiment has it: the first pose.
"""

import math
from pathlib import Path

from backend.recordings.datasets.base import KNOWN_SIGMA_M, rows
from estimator.measurements import AnyReading, Displacement, Node, Range

NAME = "plaza1"
RECORDINGS: tuple[str, ...] = ()
ROBOT = "robot"


def readings(folder: Path, recording: str | None = None) -> list[AnyReading]:
    """The readings of the data set in `folder`.

    Args:
        folder: where `odometry.csv`, `ranges.csv` and `groundtruth.csv` (for its first row) are.
        recording: there is but one.

    Raises:
        NotTheDataSet: a file is missing.
    """
    del recording
    start = next(rows(folder / "groundtruth.csv"))
    since, heading = start.number("t_s"), start.number("heading_rad")
    introduced: list[AnyReading] = [
        Node(
            t=since,
            node=ROBOT,
            role="responder",
            callsign="Mower",
            position_m=(start.number("x_m"), start.number("y_m"), 0.0),
            sigma_m=KNOWN_SIGMA_M,
            heading_sigma_rad=0.01,
        )
    ]
    ranges = [
        Range(
            t=row.number("t_s"),
            a=ROBOT,
            b=f"beacon-{row.word('beacon_id')}",
            range_m=row.number("range_raw_m"),
            technology="uwb",
        )
        for row in rows(folder / "ranges.csv")
    ]
    introduced += [Node(t=since, node=name, role="beacon") for name in sorted({r.b for r in ranges})]
    driven: list[AnyReading] = []
    # The unit's frame has x east as the first pose has it; what it turns afterwards is its own error.
    for row in rows(folder / "odometry.csv"):
        t, dist_m, turn_rad = row.number("t_s"), row.number("dist_m"), row.number("dheading_rad")
        along = heading + turn_rad / 2.0  # the chord of an arc
        heading += turn_rad
        delta_m = (dist_m * math.cos(along), dist_m * math.sin(along), 0.0)
        driven.append(Displacement(t=t, node=ROBOT, delta_m=delta_m, from_t=since, heading_rad=heading))
        since = t
    return [*introduced, *driven, *ranges]
