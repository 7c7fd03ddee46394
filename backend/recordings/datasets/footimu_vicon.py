"""footimu_vicon: walks with an inertial unit on a boot, in a room of three metres with motion capture.

Of the truth two places are used: where the boot stands at first, as the experiment has it, and, for what its
unit faces there is in no file, where it stands first a good step away. The cameras' axes are left-handed:
seen from above, y is to the right of x.
"""

import math
from pathlib import Path

from backend.recordings.datasets.base import ANEW, KNOWN_SIGMA_M, NotTheDataSet, Vector3, numbers, samples
from estimator.measurements import AnyReading, Node, Position

NAME = "footimu_vicon"
RECORDINGS = ("2017-11-22-11-22-03", "2017-11-22-11-25-20", "2017-11-22-11-50-42", "2018-02-22-10-10-56")
BOOT = "boot"
RATE_HZ = 200.0
COLUMNS = ("t_s", "ax", "ay", "az", "gx", "gy", "gz", "x_m", "y_m", "z_m")
STEP_M = 1.0
STANDING_M, STANDING = 0.005, 20
"""A boot that moves no farther in so many samples stands."""


def readings(folder: Path, recording: str | None = None) -> list[AnyReading]:
    """The readings of one walk.

    Args:
        folder: where the walk's file `<recording>.csv` is.
        recording: which walk.

    Raises:
        NotTheDataSet: the file is missing.
    """
    recording = recording or RECORDINGS[0]
    table = walked(folder, recording)
    first = table[0]
    begins = Node(
        t=first["t_s"],
        node=BOOT,
        role="responder",
        callsign="Boot",
        position_m=place_of(first),
        sigma_m=KNOWN_SIGMA_M,
        heading_sigma_rad=math.pi,
    )
    there = _standing_away(folder / f"{recording}.csv", table)
    fix = Position(t=there["t_s"], node=BOOT, position_m=place_of(there), sigma_m=(KNOWN_SIGMA_M,) * 3)
    forces = [(row["ax"], row["ay"], row["az"]) for row in table]
    rates = [(row["gx"], row["gy"], row["gz"]) for row in table]
    return [begins, fix, *samples(BOOT, RATE_HZ, [row["t_s"] for row in table], forces, rates)]


def walked(folder: Path, recording: str) -> list[dict[str, float]]:
    """The rows of a walk."""
    return numbers(folder / f"{recording}.csv", COLUMNS)


def place_of(row: dict[str, float]) -> Vector3:
    """East, north and up of a row (m)."""
    return row["x_m"], -row["y_m"], row["z_m"]


def _standing_away(path: Path, table: list[dict[str, float]]) -> dict[str, float]:
    """The row in which the boot stands first a step away from where it was at first."""
    start = place_of(table[0])
    for before, here, after in zip(table, table[STANDING:], table[2 * STANDING :], strict=False):
        if (
            math.dist(start, place_of(here)) > STEP_M
            and math.dist(place_of(before), place_of(here)) < STANDING_M
            and math.dist(place_of(here), place_of(after)) < STANDING_M
        ):
            return here
    raise NotTheDataSet(f"{path}: the boot stands nowhere {STEP_M:g} m from its first place: {ANEW}")
