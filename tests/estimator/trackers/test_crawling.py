"""Crews that crawl through rooms, of which their units tell too little, or too much."""

from dataclasses import replace
from itertools import groupby

import numpy as np
import pytest

from estimator.simulate import scenario, team
from estimator.simulate.pdr import PdrUnit
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside

UNTIL_S, ELSEWHERE_M = 300.0, 2.0
RANGED, BY_POWERS = 45, 43
"""Nights of `search-night`: with UWB, and without."""


def elsewhere_s(seed: int, tells: float, monkeypatch: pytest.MonkeyPatch) -> tuple[int, int]:
    """Seconds of people surely elsewhere, and all, where units tell such a share of a crawl."""
    usual = team.typical_unit

    def unit(rng: np.random.Generator) -> PdrUnit:
        return replace(usual(rng), crawls=tells)

    monkeypatch.setattr(team, "typical_unit", unit)
    played, tracker, wrong, seconds = scenario("search-night", seed), KirchhoffTracker(), 0, 0
    told = [report for report in played.reports if report.sent_s < UNTIL_S]
    for _, reports in groupby(told, key=lambda report: int(report.sent_s)):
        tracker.fold([report.reading for report in reports])
        for found in tracker.estimates():
            if found.role == "responder" and found.position_m is not None:
                at_m = played.truth[found.node].at(np.array([found.t]))[0]
                off_m = np.hypot(*(np.array(found.position_m[:2]) - at_m[:2]))
                squared = outside(found.position_m, found.covariance_m2, at_m)
                wrong, seconds = wrong + int(off_m > ELSEWHERE_M and squared > SURE), seconds + 1
    return wrong, seconds


@pytest.mark.parametrize(
    ("seed", "tells"), [(RANGED, 0.85), (RANGED, 1.0), (BY_POWERS, 0.85), (BY_POWERS, 1.0), (BY_POWERS, 1.1)]
)
def test_who_crawls_is_not_surely_elsewhere(seed: int, tells: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """With one scale for crawls and walks 660 and 0 of 1,200 s, and 591, 0 and 169 of 900 (decision 0129)."""
    wrong, seconds = elsewhere_s(seed, tells, monkeypatch)
    assert seconds > UNTIL_S
    assert wrong < 0.05 * seconds
