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
STANDING_M, STANDING = 0.015, 20
"""A boot that moves no farther in so many samples stands, or rolls over its sole."""


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
    there_t, there = _standing_away(folder / f"{recording}.csv", table)
    fix = Position(t=there_t, node=BOOT, position_m=there, sigma_m=(KNOWN_SIGMA_M,) * 3)
    forces = [(row["ax"], row["ay"], row["az"]) for row in table]
    rates = [(row["gx"], row["gy"], row["gz"]) for row in table]
    return [begins, fix, *samples(BOOT, RATE_HZ, [row["t_s"] for row in table], forces, rates)]


def walked(folder: Path, recording: str) -> list[dict[str, float]]:
    """The rows of a walk."""
    return numbers(folder / f"{recording}.csv", COLUMNS)


def footholds(table: list[dict[str, float]]) -> list[tuple[float, float, Vector3]]:
    """Where the boot stood for `STANDING` samples at least: since and until when (s), and its mean place (m).

    Args:
        table: the rows of a walk.
    """
    found: list[tuple[float, float, Vector3]] = []
    stood: list[dict[str, float]] = []
    for here, after in zip(table, table[STANDING:], strict=False):
        if math.dist(place_of(here), place_of(after)) < STANDING_M:
            stood.append(here)
            continue
        if len(stood) >= STANDING:
            found.append(_foothold(stood))
        stood = []
    return found if len(stood) < STANDING else [*found, _foothold(stood)]


def _foothold(stood: list[dict[str, float]]) -> tuple[float, float, Vector3]:
    places = list(zip(*(place_of(row) for row in stood), strict=True))
    east, north, up = (sum(axis) / len(axis) for axis in places)
    half_s = 0.5 * STANDING / RATE_HZ
    return stood[0]["t_s"] + half_s, stood[-1]["t_s"] + half_s, (east, north, up)


def place_of(row: dict[str, float]) -> Vector3:
    """East, north and up of a row (m)."""
    return row["x_m"], -row["y_m"], row["z_m"]


def _standing_away(path: Path, table: list[dict[str, float]]) -> tuple[float, Vector3]:
    """When the boot stands first a step away from where it was at first (s), and where (m)."""
    start = place_of(table[0])
    for since_t, until_t, place in footholds(table):
        if math.dist(start, place) > STEP_M:
            return 0.5 * (since_t + until_t), place
    raise NotTheDataSet(f"{path}: the boot stands nowhere {STEP_M:g} m from its first place: {ANEW}")
