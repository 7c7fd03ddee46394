"""The public data sets become logs that hold every row once, in order, and nothing of the truth."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import msgspec
import numpy as np
import pytest

from backend.errors import CommandRefused
from backend.recordings import NotTheDataSet, convert, converter_names, import_log
from backend.recordings.datasets.truth import truth_of
from estimator.measurements import AnyReading, Displacement, Node, Range, Rssi


class Line(msgspec.Struct, forbid_unknown_fields=True):
    gateway: str
    batch: str
    sent: float
    readings: list[AnyReading]


def converted(name: str, shared_data: Path) -> list[Line]:
    folder = shared_data / name.partition(":")[0]
    return [msgspec.json.decode(line, type=Line) for line in convert(name, folder)]


def readings(name: str, shared_data: Path) -> list[AnyReading]:
    return [reading for line in converted(name, shared_data) for reading in line.readings]


def rows(path: Path) -> int:
    with path.open() as file:
        return sum(1 for line in file if line.strip()) - 1


def test_all_data_sets_have_a_converter() -> None:
    names = converter_names()
    assert {name.partition(":")[0] for name in names} == {
        "ble_rssi_danis",
        "footimu_gcp",
        "footimu_vicon",
        "labyrinth_uwb",
        "plaza1",
        "uwb_outdoor_hanyang",
    }


@pytest.mark.parametrize("name", converter_names())
def test_time_goes_on_in_batches_of_a_second_with_keys_of_their_own(name: str, shared_data: Path) -> None:
    lines = converted(name, shared_data)
    epochs = [reading.t for line in lines for reading in line.readings]
    assert epochs == sorted(epochs)
    assert all(line.readings[-1].t - line.readings[0].t < 1.0 for line in lines)
    assert all(line.sent == max(reading.until_t for reading in line.readings) for line in lines)
    assert len({line.batch for line in lines}) == len(lines)


@pytest.mark.parametrize("name", converter_names())
def test_every_node_is_introduced_in_the_first_line(name: str, shared_data: Path) -> None:
    lines = converted(name, shared_data)
    introduced = {reading.node for reading in lines[0].readings if isinstance(reading, Node)}
    measured = {
        node
        for line in lines
        for reading in line.readings
        if isinstance(reading, Range | Rssi)
        for node in (reading.a, reading.b)
    }
    assert measured <= introduced


def test_plaza1_has_a_reading_for_every_row(shared_data: Path) -> None:
    found = readings("plaza1", shared_data)
    driven = [r for r in found if isinstance(r, Displacement)]
    assert len(driven) == rows(shared_data / "plaza1/odometry.csv") == 9657
    assert sum(isinstance(r, Range) for r in found) == rows(shared_data / "plaza1/ranges.csv") == 3529
    assert all(after.from_t == before.t for before, after in pairwise(driven))


def test_plaza1_begins_with_the_first_pose_and_four_beacons_at_unknown_places(shared_data: Path) -> None:
    nodes = [r for r in readings("plaza1", shared_data) if isinstance(r, Node)]
    robot, beacons = nodes[0], nodes[1:]
    assert (robot.role, robot.position_m) == ("responder", (0.0, 0.0, 0.0))
    assert sorted(b.node for b in beacons) == ["beacon-0", "beacon-1", "beacon-5", "beacon-6"]
    assert all(b.role == "beacon" and b.position_m is None for b in beacons)


def test_plaza1_ranges_are_passed_on_raw(shared_data: Path) -> None:
    first = next(r for r in readings("plaza1", shared_data) if isinstance(r, Range))
    assert (first.t, first.a, first.b, first.range_m) == (3858.062, "robot", "beacon-5", 65.466)
    assert (first.technology, first.sigma_m) == ("uwb", None)


def test_plaza1_added_up_stays_near_the_truth_in_a_frame_whose_x_is_east(shared_data: Path) -> None:
    driven = [r for r in readings("plaza1", shared_data) if isinstance(r, Displacement)]
    place = np.cumsum([r.delta_m for r in driven], axis=0)
    _, truth = truth_of("plaza1", shared_data / "plaza1")["robot"]
    error = np.linalg.norm(place - truth[1:], axis=1)
    assert error.mean() < 2.0
    assert error.max() < 5.0


def test_labyrinth_has_a_reading_for_every_row_and_no_pose_to_start_from(shared_data: Path) -> None:
    found = readings("labyrinth_uwb", shared_data)
    assert sum(isinstance(r, Displacement) for r in found) == 233
    assert sum(isinstance(r, Range) for r in found) == 233
    robot = next(r for r in found if isinstance(r, Node) and r.role == "responder")
    assert robot.position_m is None
    assert robot.heading_sigma_rad == pytest.approx(math.pi)
    anchors = {r.node: r.position_m for r in found if isinstance(r, Node) and r.role == "anchor"}
    assert anchors["anchor-107"] == (-0.02, 2.365, 0.0)
    assert len(anchors) == 4
    assert {r.sigma_m for r in found if isinstance(r, Range)} == {0.1}


def test_labyrinth_odometry_has_the_shape_of_the_true_way(shared_data: Path) -> None:
    driven = [r for r in readings("labyrinth_uwb", shared_data) if isinstance(r, Displacement)]
    place = np.cumsum([r.delta_m for r in driven], axis=0)
    _, truth = truth_of("labyrinth_uwb", shared_data / "labyrinth_uwb")["robot"]
    a, b = (m[:, 0] + 1j * m[:, 1] - np.mean(m[:, 0] + 1j * m[:, 1]) for m in (place, truth))
    turned = a * np.exp(1j * np.angle(np.vdot(a, b)))
    assert np.sqrt(np.mean(np.abs(turned - b) ** 2)) < 0.08


@pytest.mark.parametrize(
    "name", ["labyrinth_uwb", "uwb_outdoor_hanyang:LOS_A1", "uwb_outdoor_hanyang:NLOS_A1"]
)
def test_ranges_anchors_and_truth_are_in_one_frame_and_one_time(name: str, shared_data: Path) -> None:
    found = readings(name, shared_data)
    anchors = {r.node: r.position_m for r in found if isinstance(r, Node) and r.role == "anchor"}
    ranges = [r for r in found if isinstance(r, Range)]
    ((epochs, truth),) = truth_of(name, shared_data / name.partition(":")[0]).values()
    t = np.array([r.t for r in ranges])
    place = np.stack([np.interp(t, epochs, truth[:, axis]) for axis in range(3)], axis=1)
    anchor = np.array([anchors[r.b] for r in ranges])
    # In the plane: the height at which the tag was carried is not in the truth.
    error = np.array([r.range_m for r in ranges]) - np.linalg.norm((place - anchor)[:, :2], axis=1)
    assert abs(np.median(error)) < 0.3


@pytest.mark.parametrize("walk", ["LOS_A1", "NLOS_A1"])
def test_hanyang_has_a_reading_for_every_row_of_every_anchor(walk: str, shared_data: Path) -> None:
    folder = shared_data / "uwb_outdoor_hanyang"
    found = readings(f"uwb_outdoor_hanyang:{walk}", shared_data)
    for anchor in (3, 5, 9, 12):
        own = [r for r in found if isinstance(r, Range) and r.b == f"anchor-{anchor}"]
        assert len(own) == rows(folder / f"{walk}_A{anchor}.csv")


@pytest.mark.parametrize("name", [n for n in converter_names() if n.startswith("ble")])
def test_danis_has_a_reading_for_every_row_and_twelve_sensors(name: str, shared_data: Path) -> None:
    found = readings(name, shared_data)
    path = shared_data / "ble_rssi_danis" / f"{name.partition(':')[2]}.csv"
    assert sum(isinstance(r, Rssi) for r in found) == rows(path)
    assert sum(isinstance(r, Node) and r.role == "anchor" for r in found) == 12


@pytest.mark.parametrize("name", ["plaza1", "labyrinth_uwb"])
def test_a_converted_data_set_is_imported_whole(name: str, shared_data: Path, tmp_path: Path) -> None:
    path = tmp_path / "converted.ndjson"
    path.write_bytes(b"".join(convert(name, shared_data / name)))
    imported = import_log(f"sqlite:///{tmp_path / 'firethread.db'}", name, path)
    lines = converted(name, shared_data)
    assert (imported.batches, imported.rejected) == (len(lines), 0)
    assert imported.accepted == sum(len(line.readings) for line in lines)


def test_an_unknown_data_set_is_answered_with_those_there_are(tmp_path: Path) -> None:
    for name in ("plaza2", "uwb_outdoor_hanyang:LOS_B1", "plaza1:x"):
        with pytest.raises(CommandRefused, match="labyrinth_uwb"):
            convert(name, tmp_path)


def test_a_folder_without_the_data_is_named(tmp_path: Path) -> None:
    for name in ("plaza1", "labyrinth_uwb", "uwb_outdoor_hanyang", "ble_rssi_danis"):
        with pytest.raises(NotTheDataSet, match=str(tmp_path)):
            convert(name, tmp_path)


DAMAGED = {
    "empty": lambda _text: b"",
    "no text": lambda text: b"\xff\x00" + text,
    "a row that ends too soon": lambda text: _with_last_line(text, lambda line: line[:4]),
    "words for numbers": lambda text: _with_last_line(
        text, lambda line: line.replace(b"1", b"x").replace(b"0", b"x")
    ),
}


def _with_last_line(text: bytes, change: Callable[[bytes], bytes]) -> bytes:
    *others, last = text.strip().splitlines()
    return b"\n".join([*others, change(last)])


@pytest.mark.parametrize("damage", DAMAGED.values(), ids=DAMAGED)
@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("plaza1", "groundtruth.csv odometry.csv ranges.csv"),
        ("labyrinth_uwb", "Indoor_UWB_Input.txt"),
        ("uwb_outdoor_hanyang", "LOS_A1_A3.csv"),
        ("ble_rssi_danis", "sensors.txt straight_01.csv"),
        ("footimu_gcp", "trial36.csv trial36_gcp.csv"),
        ("footimu_vicon", "2017-11-22-11-22-03.csv"),
    ],
)
def test_a_damaged_file_is_refused_by_its_name(
    name: str, read: str, damage: Callable[[bytes], bytes], shared_data: Path, tmp_path: Path
) -> None:
    for damaged in read.split():
        folder = tmp_path / damaged
        folder.mkdir()
        for path in (shared_data / name).iterdir():
            (folder / path.name).symlink_to(path)
        (folder / damaged).unlink()
        whole = (shared_data / name / damaged).read_bytes()
        if damaged == "groundtruth.csv":  # of which the first row alone is read
            whole = b"\n".join(whole.splitlines()[:2])
        if damaged == "sensors.txt":  # of which one line is
            whole = next(line for line in whole.splitlines() if line.startswith(b"Dongles:"))
        (folder / damaged).write_bytes(damage(whole))
        chosen = ":straight_01" if name == "ble_rssi_danis" else ""
        with pytest.raises(NotTheDataSet, match=damaged) as refused:
            list(convert(name + chosen, folder))
        assert "\n" not in str(refused.value)
