"""Accuracy on public recordings, with one set of parameters and no truth in the readings."""

from functools import cache
from pathlib import Path

import pytest

from backend.bench.accuracy.cases import Case, case_of
from backend.bench.accuracy.entrants import Mode, entrants
from backend.bench.accuracy.judge import judge

WALKS = ["uwb_outdoor_hanyang:LOS_A1", "uwb_outdoor_hanyang:NLOS_A1"]


@cache
def recording(data: Path, name: str) -> Case:
    return case_of(name, 0, data)


def rmse_m(case: Case, entrant: str, mode: Mode) -> float:
    """Horizontal error, anchored at the recording's first pose or its anchors."""
    found = next(e for e in entrants() if (e.name, e.mode) == (entrant, mode))
    return judge(found.track(case.reports), case.truth, found.heights).errors.rmse_m


def test_plaza1_online_with_unknown_beacons_stays_within_a_metre(shared_data: Path) -> None:
    assert rmse_m(recording(shared_data, "plaza1"), "kirchhoff", "online") <= 1.0


def test_plaza1_smoothed_stays_within_90_cm(shared_data: Path) -> None:
    assert rmse_m(recording(shared_data, "plaza1"), "kirchhoff", "smoothed") <= 0.9


@pytest.mark.parametrize("walk", WALKS)
def test_a_walker_without_pdr_is_followed_by_ranges_alone(shared_data: Path, walk: str) -> None:
    """The recording's authors: 1.12 and 0.94 m with a Kalman filter on the same ranges and inertial data."""
    assert rmse_m(recording(shared_data, walk), "kirchhoff", "online") <= 0.8
    assert rmse_m(recording(shared_data, walk), "kirchhoff", "smoothed") <= 0.6


def test_among_obstructed_anchors_it_errs_half_as_much_as_a_fix_of_each_second(shared_data: Path) -> None:
    case = recording(shared_data, "labyrinth_uwb")
    assert rmse_m(case, "kirchhoff", "online") <= 0.5 * rmse_m(case, "least-squares", "online")
