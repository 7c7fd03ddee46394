"""The true positions of the data sets, for evaluation only: nothing here ever meets a reading."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backend.recordings.datasets import footimu_gcp, footimu_vicon
from backend.recordings.datasets.base import rows, words

FloatArray = NDArray[np.float64]
Truth = tuple[FloatArray, FloatArray]
"""Epochs, n (s, as the readings count), and positions, n × 3 (m)."""


def truth_of(name: str, folder: Path) -> dict[str, Truth]:
    """The true track of each node whose truth is known.

    Args:
        name: as `backend.recordings.datasets.convert` takes it.
        folder: the data set's folder.

    Raises:
        KeyError: there is no such data set.
        NotTheDataSet: the folder does not hold its truth.
    """
    data_set, _, recording = name.partition(":")
    return _READERS[data_set](folder, recording)


def _plaza1(folder: Path, recording: str) -> dict[str, Truth]:
    del recording
    robot = [
        (r.number("t_s"), r.number("x_m"), r.number("y_m"), 0.0) for r in rows(folder / "groundtruth.csv")
    ]
    found = {"robot": _truth(robot)}
    for row in rows(folder / "beacons.csv"):
        found[f"beacon-{row.word('beacon_id')}"] = _truth(
            [(robot[0][0], row.number("x_m"), row.number("y_m"), 0.0)]
        )
    return found


def _labyrinth(folder: Path, recording: str) -> dict[str, Truth]:
    del recording
    table = words(folder / "Indoor_UWB_GT.txt")
    return {
        "robot": _truth(
            [(r.number(1), r.number(2), r.number(3), 0.0) for r in table if r.word(0) == "point2"]
        )
    }


def _hanyang(folder: Path, recording: str) -> dict[str, Truth]:
    table = rows(folder / f"{recording or 'LOS_A1'}_trajectory.csv")
    return {
        "tag": _truth(
            [(r.number("timestamp") / 1e9, r.number("x"), r.number("y"), r.number("z")) for r in table]
        )
    }


def _danis(folder: Path, recording: str) -> dict[str, Truth]:
    table = rows(folder / f"{recording or 'rectangular_with_rotation'}.csv")
    return {
        "beacon1": _truth(
            [(r.number("timestamp"), r.number("x_m"), r.number("y_m"), r.number("z_m")) for r in table]
        )
    }


def _vicon(folder: Path, recording: str) -> dict[str, Truth]:
    table = footimu_vicon.walked(folder, recording or footimu_vicon.RECORDINGS[0])
    return {"boot": _truth([(row["t_s"], *footimu_vicon.place_of(row)) for row in table])}


def _gcp(folder: Path, recording: str) -> dict[str, Truth]:
    """A boot that stands on a tile does not go on; between two it swings in less time than it stands."""
    del recording
    stood = footimu_gcp.tiles(folder)
    return {"boot": _truth([(t, x, y, 0.0) for since_t, until_t, x, y in stood for t in (since_t, until_t)])}


def _truth(table: list[tuple[float, float, float, float]]) -> Truth:
    values = np.array(table, dtype=np.float64)
    return values[:, 0], values[:, 1:]


_READERS: dict[str, Callable[[Path, str], dict[str, Truth]]] = {
    "plaza1": _plaza1,
    "labyrinth_uwb": _labyrinth,
    "uwb_outdoor_hanyang": _hanyang,
    "ble_rssi_danis": _danis,
    "footimu_vicon": _vicon,
    "footimu_gcp": _gcp,
}
