"""The true positions of the data sets, for evaluation only: nothing here ever meets a reading."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backend.recordings.datasets import footimu_gcp, footimu_vicon
from backend.recordings.datasets.base import Vector3, rows, words

FloatArray = NDArray[np.float64]
HALF_STANCE_S = 0.3
"""Of who walks: stance is 60 % of a stride of 1.0 to 1.2 s (Perry, Gait Analysis)."""
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
    return {"boot": _bearer(footimu_vicon.footholds(table))}


def _gcp(folder: Path, recording: str) -> dict[str, Truth]:
    del recording
    stood = footimu_gcp.tiles(folder)
    return {"boot": _bearer([(since_t, until_t, (x, y, 0.0)) for since_t, until_t, x, y in stood])}


def _bearer(footholds: Sequence[tuple[float, float, Vector3]]) -> Truth:
    """The way of who wears a boot, of which alone is known where it stood, since when and until when (s).

    He passes over it in the middle of a stance, goes on while it waits for him, and is half a stride ahead of
    it when it leaves. On whichever he stands for longer, there he is until half a stance before he goes on.
    """
    passed = []
    for since_t, until_t, place in footholds:
        half_s = min(HALF_STANCE_S, 0.5 * (until_t - since_t))
        passed += [(t, *place) for t in sorted({since_t + half_s, until_t - half_s})]
    return _truth(passed)


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
