"""Who walks out of a radio's reach and back into it is placed by that, as sharply as reaches agree."""

from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest

from estimator.evidence import Measurement
from estimator.fusion.entering.technologies import REACH
from estimator.fusion.learned.reach import EXPONENT
from estimator.fusion.memory.state import FusionState
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.simulate import Scenario, scenario
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.smoothing.windows import fused

REACH_M = 25.0
"""Of all radios in paper A's scenario."""
STEP_M = 1.0


@cache
def incident(name: str = "paper-a", seed: int = 1) -> Scenario:
    return scenario(name, seed)


def readings(name: str = "paper-a") -> list[AnyReading]:
    return [report.reading for report in incident(name).reports]


def folded(told: Sequence[AnyReading]) -> FusionState:
    return fused(told)


def crossings(state: FusionState) -> list[tuple[float, str]]:
    """Epoch and radio of each crossing that was fused."""
    if REACH not in state.sources:
        return []
    pairs = state.ledger.table("pairs")
    mine = pairs[pairs[:, 6] == state.sources.index(REACH)]
    return [(row[0], state.owners[int(row[3])]) for row in mine.tolist()]


def estimates_m(tracker: KirchhoffTracker) -> dict[str, tuple[float, float, float] | None]:
    return {found.node: found.position_m for found in tracker.estimates()}


def test_he_is_at_the_reach_of_a_radio_when_it_falls_silent_or_is_heard_again() -> None:
    truth = incident().truth
    found = crossings(folded(readings()))
    assert len(found) > 30
    for t, radio in found:
        apart_m = np.linalg.norm(truth["ff1"].at(np.array([t])) - truth[radio].position_m[:1])
        assert apart_m == pytest.approx(REACH_M, abs=STEP_M)


def test_reaches_that_are_all_the_same_are_found_to_be() -> None:
    state = folded(readings())
    variable = next(v for v in state.graph.starts if v.kind == "rssi" and v.owner == "reach")
    reach_m = 10.0 ** (float(state.graph.value(variable)[0]) / (10.0 * EXPONENT))
    assert reach_m == pytest.approx(REACH_M, abs=STEP_M)
    assert state.reach.sigma_db < 0.3


@pytest.mark.parametrize("name", ["kicked-breadcrumb", "office-fire"])
def test_where_packets_are_lost_silence_tells_nothing(name: str) -> None:
    told = readings(name)
    first_s = min(r.t for r in told)
    assert crossings(folded([r for r in told if r.t < first_s + 120.0])) == []


def test_who_has_no_unit_crosses_no_reach() -> None:
    """Where he was between two seconds nobody knows."""
    assert crossings(folded([r for r in readings() if not isinstance(r, Displacement)])) == []


@pytest.mark.parametrize("sweeps", [1, 4])
def test_of_a_unit_that_tells_the_strongest_few_no_silence_is_a_reach(sweeps: int) -> None:
    """Along a row of radios, of which it tells three: which these are may change within a second."""
    told: list[AnyReading] = [Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))]
    places_m = {f"b{k}": (10.0 * k, 2.0, 0.0) for k in range(16)}
    told += [Node(t=0.0, node=name, role="breadcrumb", position_m=at) for name, at in places_m.items()]
    for number in range(1, 120 * sweeps + 1):
        t = number / sweeps
        nearest = sorted(range(16), key=lambda k: abs(10.0 * k - 1.3 * t))[:3]
        for k in nearest:
            apart_m = float(np.hypot(10.0 * k - 1.3 * t, 2.0))
            told.append(Rssi(t=t, a="ff1", b=f"b{k}", dbm=-42.0 - 22.0 * float(np.log10(apart_m))))
        if number % sweeps == 0:
            told.append(Displacement(t=t, node="ff1", delta_m=(1.3, 0.0, 0.0)))
    state = folded(told)
    assert state.reach.silent is not None
    assert crossings(state) == []


def test_a_second_that_comes_in_two_halves_gives_what_it_gives_at_once() -> None:
    """Before the second half has come, no radio of it has fallen silent."""
    first = [r for r in readings() if r.t <= 60.0]
    early = [r for r in first if not (isinstance(r, Rssi) and r.t == 60.0 and r.b > "b2")]
    halves, whole = KirchhoffTracker(), KirchhoffTracker()
    for tracker, told in ((halves, early), (whole, first)):
        tracker.fold(told)
    known = crossings(halves._lag.state())
    assert known == crossings(whole._lag.state())
    halves.fold([r for r in first if r not in early])
    assert estimates_m(halves) == estimates_m(whole)


@pytest.mark.parametrize("until_s", [26.0, 51.0, 70.0])
def test_a_tracker_restored_beside_a_crossing_goes_on_to_the_last_bit(until_s: float) -> None:
    tracker = KirchhoffTracker()
    tracker.fold([r for r in readings() if r.t <= until_s])
    tracker.estimates()
    restored = KirchhoffTracker.restore(tracker.snapshot())
    for one in (tracker, restored):
        one.fold([r for r in readings() if until_s < r.t <= until_s + 30.0])
    assert estimates_m(restored) == estimates_m(tracker)


def test_evidence_names_a_crossing_by_the_reach_in_metres() -> None:
    evidence = BatchSmoother().evidence([r for r in readings() if r.t <= 127.0], "ff1")
    assert evidence is not None
    found: list[Measurement] = [one for one in evidence.held if one.kind == "reach"]
    assert found
    for one in found:
        assert one.value == pytest.approx(REACH_M, abs=2.0)
        assert abs(one.residual) < 2.0
        assert 0.2 < one.sigma < 3.0
