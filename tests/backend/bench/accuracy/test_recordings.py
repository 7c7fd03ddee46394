"""Accuracy on public recordings, with one set of parameters and no truth in the readings."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from msgspec import structs

from backend.bench.accuracy.cases import Case, case_of
from backend.bench.accuracy.entrants import Mode, entrants
from backend.bench.accuracy.judge import judge
from backend.recordings.datasets import footimu_vicon
from estimator.evaluate import Errors
from estimator.measurements.range import Range
from estimator.simulate import Report
from tests.backend.bench.accuracy.plaza2 import plaza2

BOOTS = [f"footimu_vicon:{walk}" for walk in footimu_vicon.RECORDINGS]
WALKS = ["uwb_outdoor_hanyang:LOS_A1", "uwb_outdoor_hanyang:NLOS_A1"]


@cache
def recording(data: Path, name: str) -> Case:
    return case_of(name, 0, data)


def errors_of(case: Case, entrant: str, mode: Mode) -> Errors:
    """Horizontal errors, anchored at the recording's first pose or its anchors."""
    found = next(e for e in entrants() if (e.name, e.mode) == (entrant, mode))
    return judge(found.track(case.reports), case.truth, found.heights).errors


def rmse_m(case: Case, entrant: str, mode: Mode) -> float:
    return errors_of(case, entrant, mode).rmse_m


def test_plaza1_online_with_unknown_beacons_stays_within_a_metre(shared_data: Path) -> None:
    """The goal for the aligned error, 0.30 m, is reached by little: it is larger until the scale is known."""
    found = errors_of(recording(shared_data, "plaza1"), "kirchhoff", "online")
    assert found.rmse_m <= 1.0
    assert found.aligned_rmse_m <= 0.32


def test_plaza1_smoothed_stays_within_90_cm_and_places_all_its_beacons(shared_data: Path) -> None:
    case = recording(shared_data, "plaza1")
    smoothed = next(e for e in entrants() if (e.name, e.mode) == ("kirchhoff", "smoothed"))
    tracks = smoothed.track(case.reports)
    assert {name for name in tracks if name.startswith("beacon")} == {f"beacon-{n}" for n in (0, 1, 5, 6)}
    found = judge(tracks, case.truth, smoothed.heights).errors
    assert found.rmse_m <= 0.9
    assert found.aligned_rmse_m <= 0.21


def test_plaza2_whose_gyro_is_biased_by_half_a_degree_a_second_is_tracked_within_a_metre(
    tmp_path: Path,
) -> None:
    """The best we know of others: 1.6 m online with bias, ZARU and range scale, 6.7 m without."""
    case = plaza2(tmp_path)
    online, smoothed = (errors_of(case, "kirchhoff", mode) for mode in ("online", "smoothed"))
    assert online.rmse_m <= 1.0
    assert online.aligned_rmse_m <= 0.5
    assert online.coverage >= 0.9
    assert smoothed.rmse_m <= 0.9
    assert smoothed.aligned_rmse_m <= 0.3
    assert smoothed.coverage >= 0.9


@pytest.mark.parametrize("walk", WALKS)
def test_a_walker_without_pdr_is_followed_by_ranges_alone(shared_data: Path, walk: str) -> None:
    """The recording's authors: 1.12 and 0.94 m with a Kalman filter on the same ranges and inertial data."""
    assert rmse_m(recording(shared_data, walk), "kirchhoff", "online") <= 0.8
    assert rmse_m(recording(shared_data, walk), "kirchhoff", "smoothed") <= 0.6


def test_every_tenth_range_too_long_by_metres_does_not_lead_the_smoothed_view_astray(
    shared_data: Path,
) -> None:
    """Beyond those that are too long in the recording: echoes of up to 10 m."""
    case, chance = recording(shared_data, WALKS[1]), np.random.default_rng(0)
    reports = tuple(_echoed(report, chance) for report in case.reports)
    assert rmse_m(case._replace(reports=reports), "kirchhoff", "smoothed") <= 0.8


def _echoed(report: Report, chance: np.random.Generator) -> Report:
    """A report whose range, one time in ten, is that of an echo."""
    if not isinstance(report.reading, Range) or chance.random() > 0.1:
        return report
    longer_m = float(chance.uniform(0.0, 10.0))
    return replace(report, reading=structs.replace(report.reading, range_m=report.reading.range_m + longer_m))


@pytest.mark.parametrize("walk", BOOTS)
def test_a_boot_is_followed_by_its_raw_samples_alone(shared_data: Path, walk: str) -> None:
    """Shapes of walks of some 30 m, one setting for all; what the boot faces at first is in no file."""
    case = recording(shared_data, walk)
    for mode in ("online", "smoothed"):
        found = errors_of(case, "kirchhoff", mode)
        assert found.coverage >= 0.9
    assert found.aligned_rmse_m <= 0.15
    assert found.rmse_m <= 0.2
    assert np.isnan(found.ve95_m) or found.ve95_m <= 0.2


def test_a_boot_on_77_m_of_tiles_errs_by_half_a_hundredth_of_its_way(shared_data: Path) -> None:
    found = errors_of(recording(shared_data, "footimu_gcp"), "kirchhoff", "smoothed")
    assert found.aligned_rmse_m <= 0.4
    assert found.mean_percent <= 0.7
    assert found.coverage >= 0.9


def test_gtsam_gets_the_displacements_that_raw_samples_make(shared_data: Path) -> None:
    found = errors_of(recording(shared_data, "footimu_gcp"), "gtsam", "smoothed")
    assert found.aligned_rmse_m <= 0.4


def test_among_obstructed_anchors_it_errs_half_as_much_as_a_fix_of_each_second(shared_data: Path) -> None:
    case = recording(shared_data, "labyrinth_uwb")
    assert rmse_m(case, "kirchhoff", "online") <= 0.5 * rmse_m(case, "least-squares", "online")


def test_what_is_known_afterwards_makes_a_track_among_obstructed_anchors_no_worse(shared_data: Path) -> None:
    case = recording(shared_data, "labyrinth_uwb")
    assert rmse_m(case, "kirchhoff", "smoothed") <= rmse_m(case, "kirchhoff", "online")
