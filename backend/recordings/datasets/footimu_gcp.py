"""footimu_gcp: a walk along a corridor and back with an inertial unit on a boot, each step on a floor tile.

It starts at the first tile. What its unit faces there is in no file, so it is told to be anything; instead
the third tile, two metres on, is given as a fix. No other of the 59 is.
"""

import math
from itertools import pairwise
from pathlib import Path

from backend.recordings.datasets.base import KNOWN_SIGMA_M, NotTheDataSet, numbers, samples
from estimator.measurements import AnyReading, Node, Position

NAME = "footimu_gcp"
RECORDINGS: tuple[str, ...] = ()
TRIAL = "trial36"
BOOT = "boot"
RATE_HZ = 200.0
G_MPS2 = 9.80665
GAUSS_UT = 100.0
FORCE, TURN, FIELD = ("ax_g", "ay_g", "az_g"), ("gx", "gy", "gz"), ("mx", "my", "mz")
GIVEN = 2
"""Which tile is given, from 0."""
STANDING_RADPS, STANDING_S = 1.0, 0.1
"""A boot that turns no faster for so long stands."""


def readings(folder: Path, recording: str | None = None) -> list[AnyReading]:
    """The readings of the walk.

    Args:
        folder: where `trial36.csv` is.
        recording: there is but one.

    Raises:
        NotTheDataSet: the file is missing.
    """
    del recording
    table = numbers(folder / f"{TRIAL}.csv", ("t_s", *FORCE, *TURN, *FIELD))
    since_t, until_t, east, north = tiles(folder)[GIVEN]
    fix = Position(
        t=0.5 * (since_t + until_t), node=BOOT, position_m=(east, north, 0.0), sigma_m=(KNOWN_SIGMA_M,) * 3
    )
    begins = Node(
        t=table[0]["t_s"],
        node=BOOT,
        role="responder",
        callsign="Boot",
        position_m=(0.0, 0.0, 0.0),
        sigma_m=KNOWN_SIGMA_M,
        heading_sigma_rad=math.pi,
    )
    forces = [(G_MPS2 * row["ax_g"], G_MPS2 * row["ay_g"], G_MPS2 * row["az_g"]) for row in table]
    rates = [(row["gx"], row["gy"], row["gz"]) for row in table]
    fields = [(GAUSS_UT * row["mx"], GAUSS_UT * row["my"], GAUSS_UT * row["mz"]) for row in table]
    return [begins, fix, *samples(BOOT, RATE_HZ, [row["t_s"] for row in table], forces, rates, fields)]


def tiles(folder: Path) -> list[tuple[float, float, float, float]]:
    """Each tile that the boot stood on: since when and until when (s), east and north (m).

    Raises:
        NotTheDataSet: a file is missing, or it stood as often as no tiles are given for.
    """
    places = [(row["x_m"], row["y_m"]) for row in numbers(folder / f"{TRIAL}_gcp.csv", ("x_m", "y_m"))]
    stood = _standstills(numbers(folder / f"{TRIAL}.csv", ("t_s", *TURN)))
    if len(stood) != len(places) or len(places) <= GIVEN:
        raise NotTheDataSet(f"{folder}: the boot stood {len(stood)} times, and {len(places)} tiles are given")
    return [(*between, *place) for between, place in zip(stood, places, strict=True)]


def _standstills(table: list[dict[str, float]]) -> list[tuple[float, float]]:
    """Since when and until when a boot stood each time (s)."""
    swings = [row["t_s"] for row in table if math.hypot(row["gx"], row["gy"], row["gz"]) > STANDING_RADPS]
    edges = [table[0]["t_s"], *swings, table[-1]["t_s"]]
    return [(one, other) for one, other in pairwise(edges) if other - one > STANDING_S]
