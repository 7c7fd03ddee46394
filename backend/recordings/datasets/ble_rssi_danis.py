"""ble_rssi_danis: a Bluetooth beacon carried through an office, heard by twelve sensors at known places."""

import re
from pathlib import Path

import msgspec

from backend.recordings.datasets.base import ANEW, KNOWN_SIGMA_M, NotTheDataSet, rows, text_of
from estimator.measurements import AnyReading, Node, Rssi

NAME = "ble_rssi_danis"
RECORDINGS = (
    "rectangular_with_rotation",
    "rectangular_without_rotation",
    "straight_01",
    "straight_05",
    "zigzagging_with_rotation",
    "zigzagging_without_rotation",
)
CARRIED = "beacon1"

_decode_sensors = msgspec.json.Decoder(dict[str, tuple[tuple[float, float, float], int, str]]).decode


def readings(folder: Path, recording: str | None = None) -> list[AnyReading]:
    """The readings of one walk.

    Args:
        folder: where `sensors.txt` and the walk's `<recording>.csv` are.
        recording: which walk.

    Raises:
        NotTheDataSet: a file is missing or has another form.
    """
    sensors = _sensors(folder / "sensors.txt")
    heard: list[AnyReading] = [
        Rssi(
            t=row.number("timestamp"),
            a=row.one_of(sensors, "mac_sensor")[0],
            b=CARRIED,
            dbm=row.number("rssi_dbm"),
        )
        for row in rows(folder / f"{recording}.csv")
    ]
    start = min(reading.t for reading in heard)
    introduced: list[AnyReading] = [Node(t=start, node=CARRIED, role="responder", callsign="Beacon 1")]
    introduced += [
        Node(t=start, node=name, role="anchor", position_m=place, sigma_m=KNOWN_SIGMA_M)
        for name, place in sensors.values()
    ]
    return [*introduced, *heard]


def _sensors(path: Path) -> dict[str, tuple[str, tuple[float, float, float]]]:
    """Name and place of each sensor, by its address."""
    found = re.search(r"^Dongles:(\{.*\})\s*$", text_of(path), re.MULTILINE)
    if found is None:
        raise NotTheDataSet(f"{path} has no line 'Dongles:{{…}}' with the sensors' places: {ANEW}")
    try:
        sensors = _decode_sensors(found[1])
    except msgspec.DecodeError as error:
        raise NotTheDataSet(f"{path}, line 'Dongles:{{…}}': {error}: {ANEW}") from error
    return {address: (name, place) for address, (place, _, name) in sensors.items()}
