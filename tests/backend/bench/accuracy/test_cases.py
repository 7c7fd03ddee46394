from itertools import pairwise
from pathlib import Path

import pytest

from backend.bench.accuracy.cases import case_of, is_simulated, names
from estimator.simulate import scenario_names


def test_every_scenario_is_a_case_and_missing_data_sets_are_told(tmp_path: Path) -> None:
    (tmp_path / "unheard_of").mkdir()
    found, left_out = names(tmp_path)
    assert found == scenario_names()
    assert any(line.startswith("plaza1: there is no folder") for line in left_out)
    assert "unheard_of: has no converter" in left_out


def test_responders_of_a_scenario_are_judged_and_nobody_else() -> None:
    case = case_of("office-fire", 0, Path())
    assert set(case.truth) == {"E7-1", "E7-2", "E7-3", "L3-1", "L3-2", "L3-3"}


def test_a_data_set_is_posted_as_it_is_measured(shared_data: Path) -> None:
    case = case_of("plaza1", 0, shared_data)
    assert not is_simulated("plaza1")
    assert set(case.truth) == {"robot"}
    assert all(report.sent_s == report.reading.t for report in case.reports)
    assert all(a.sent_s <= b.sent_s for a, b in pairwise(case.reports))
    assert case.truth["robot"].distance_m == pytest.approx(1859.0, abs=60.0)
