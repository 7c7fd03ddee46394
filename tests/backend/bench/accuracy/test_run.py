import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from backend.bench.accuracy import cases
from backend.bench.accuracy.cases import Case
from backend.bench.accuracy.entrants import Entrant, Tracks
from backend.bench.accuracy.outcome import ABSENT
from backend.bench.accuracy.run import Choice, outcome_of, run
from backend.errors import CommandRefused
from estimator.estimate import TrackPoint
from estimator.simulate import Report
from tests.backend.bench.accuracy.short import NAME, build, true_track

CHEAP = ["gtsam", "least-squares"]


@pytest.fixture
def only_short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cases, "scenario_names", lambda: [NAME])
    monkeypatch.setattr(cases, "scenario", lambda _, seed: build(seed))


@pytest.mark.usefixtures("only_short")
def test_the_report_says_what_the_table_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "report.html"
    run(Choice(seeds=2, trackers=CHEAP, data=tmp_path, html=file))
    printed, page = capsys.readouterr().out, file.read_text()
    rows = [line.split() for line in printed.splitlines() if re.match("  (online|smoothed) ", line)]
    assert [row[:2] for row in rows] == [
        ["online", "gtsam"],
        ["online", "least-squares"],
        ["smoothed", "gtsam"],
    ]
    for row in rows:
        assert 0.0 < float(row[2]) < 1.0
        assert "".join(f"<td>{cell}</td>" for cell in row[2:12]) in page
    assert page.count("<svg") == 2
    assert page.count("<polyline") == 1 + 2 * len(rows)
    assert "http" not in page


@pytest.mark.usefixtures("only_short")
def test_data_sets_that_are_not_there_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(Choice(seeds=1, trackers=["least-squares"], data=tmp_path))
    assert f"left out: plaza1: there is no folder {tmp_path / 'plaza1'}" in capsys.readouterr().out


@pytest.mark.parametrize("choice", [Choice(only=["nowhere"]), Choice(trackers=["nobody"])])
def test_unknown_names_are_refused_with_those_there_are(choice: Choice, tmp_path: Path) -> None:
    with pytest.raises(CommandRefused, match="there are"):
        run(choice._replace(data=tmp_path))


def test_an_entrant_gets_the_readings_and_nothing_else() -> None:
    scenario = build(0)
    given: list[object] = []

    def takes(reports: Sequence[Report]) -> bool:
        given.append(reports)
        return True

    def track(reports: Sequence[Report]) -> Tracks:
        given.append(reports)
        return {"ff": [TrackPoint(t=1.0, position_m=(2.0, 0.0, 0.0), covariance_m2=(1, 0, 0, 1, 0, 1))]}

    outcome_of(
        Case(NAME, scenario.reports, {"ff": true_track()}),
        0,
        Entrant("spy", "online", heights=False, takes=takes, track=track),
    )
    assert given == [scenario.reports, scenario.reports]


def test_failures_and_absences_are_outcomes() -> None:
    scenario = build(0)
    case = Case(NAME, scenario.reports, {"ff": true_track()})

    def gives_up(_: Sequence[Report]) -> Tracks:
        raise RuntimeError("Indeterminant linear system\n detected")

    fails = Entrant("fails", "online", heights=False, takes=lambda _: True, track=gives_up)
    assert outcome_of(case, 0, fails).failed == "Indeterminant linear system detected"
    assert outcome_of(case, 0, fails._replace(takes=lambda _: False)).failed == ABSENT
    assert outcome_of(case, 0, fails._replace(track=lambda _: {})).failed == "no responder has an estimate"
