"""Why a fix is where it is, and what would make it surer."""

import math

import pytest

from estimator import trackers
from estimator.measurements import AnyReading, Node
from estimator.measurements.displacement import Displacement
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.simulate import late_gateway
from estimator.smoothing.results import evidence
from estimator.trackers.base import TrackerSettings
from tests.estimator.walks import behind_a_wall, standing_radios, two_responders

SMOOTHER = trackers.smoother("kirchhoff", TrackerSettings())


def walk() -> list[AnyReading]:
    return [r for r in two_responders(40) if r.t <= 35.0]


def test_the_shares_of_all_currents_add_up_to_one() -> None:
    found = SMOOTHER.evidence(walk(), "ff1")
    assert found is not None
    assert sum(m.share for m in found.held) + found.rest == pytest.approx(1.0, abs=1e-9)
    assert all(m.share >= 0.0 for m in found.held)
    assert [m.share for m in found.held] == sorted((m.share for m in found.held), reverse=True)


def test_powers_hold_nobody_by_what_a_wall_around_him_takes_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evidence, "HELD_MAX", 1_000_000)
    told = [reading for reading in late_gateway.build(1).readings if reading.t <= 60.0]
    found = SMOOTHER.evidence(told, "E7-1")
    assert found is not None
    assert sum(m.kind == "rssi" for m in found.held) > 20
    assert 0.95 < sum(m.share for m in found.held) <= 1.0


def test_who_has_hardly_been_measured_is_held_by_where_he_is_taken_to_have_begun() -> None:
    base = Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0))
    step = Displacement(t=1.0, node="ff1", delta_m=(3.0, 4.0, 0.0))
    found = SMOOTHER.evidence([base, Node(t=0.0, node="ff1", role="responder"), step], "ff1")
    assert found is not None
    assert [(m.kind, m.a) for m in found.held] == [("prior", "ff1"), ("displacement", "ff1")]
    assert found.held[0].share > 0.99
    assert sum(m.share for m in found.held) == pytest.approx(1.0, abs=1e-9)


def test_a_straight_leg_holds_who_has_gone_on_after_it() -> None:
    """Nobody is heard: that he walked straight is all that tells of his unit's gyro."""
    begun = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1)
    ways = [(1.0, 0.0, 0.0)] * 30 + [(0.0, 1.0, 0.0)] * 30
    steps = [
        Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=way) for t, way in enumerate(ways, start=1)
    ]
    found = SMOOTHER.evidence([begun, *steps], "ff1")
    assert found is not None
    straight = [m for m in found.held if m.kind == "straightness"]
    assert len(straight) == 2, "the leg that is over, and the one that he is on"
    over, under_way = sorted(m.t for m in straight)
    assert over == 31.0
    assert 45.0 < under_way <= 60.0
    assert max(m.share for m in straight) > 0.05
    for leg in straight:
        assert leg.a == "ff1"
        assert leg.value == pytest.approx(0.0, abs=1e-9)
        assert leg.weight > 0.8


def test_an_anchor_is_held_by_what_was_told_of_it() -> None:
    found = SMOOTHER.evidence(walk(), "anchor")
    assert found is not None
    assert (found.held[0].kind, found.held[0].a) == ("prior", "anchor")
    assert found.held[0].sigma == pytest.approx(0.05)
    assert found.held[0].share > 0.5


def test_where_nobody_moves_an_anchor_and_what_is_ranged_from_it_are_held_as_well() -> None:
    found = SMOOTHER.evidence(standing_radios(), "anchor0")
    assert found is not None
    assert (found.held[0].kind, found.held[0].a) == ("prior", "anchor0")
    assert found.held[0].share > 0.5
    ranged = SMOOTHER.evidence(standing_radios(), "beacon")
    assert ranged is not None
    assert {m.a for m in ranged.held if m.kind == "prior"} >= {"anchor0", "anchor1", "anchor2"}
    assert sum(m.share for m in ranged.held) + ranged.rest == pytest.approx(1.0, abs=1e-9)


def test_a_sharp_fix_now_holds_the_position_alone() -> None:
    before = SMOOTHER.evidence(walk(), "ff1")
    assert before is not None
    fix = Position(t=35.0, node="ff1", position_m=before.position_m, sigma_m=(0.02, 0.02, 0.02))
    found = SMOOTHER.evidence([*walk(), fix], "ff1")
    assert found is not None
    assert found.held[0].kind == "fix"
    assert found.held[0].share > 0.5


def test_an_absurd_range_is_listed_as_rejected() -> None:
    absurd = Range(t=34.5, a="ff1", b="base", range_m=90.0, technology="uwb")
    found = SMOOTHER.evidence([*walk(), absurd], "ff1")
    assert found is not None
    assert [m.value for m in found.rejected] == [90.0]
    assert found.rejected[0].weight < 0.01


def test_a_range_through_a_wall_is_too_long_by_what_its_radio_said() -> None:
    """The smoothed view takes off what it thinks that walls add; evidence keeps to what was measured."""
    found = SMOOTHER.evidence(behind_a_wall(), "ff2")
    assert found is not None
    ways = SMOOTHER.smooth(behind_a_wall())
    beacon = ways["beacon"][-1].position_m
    walled = [m for m in found.held if m.kind == "range" and m.b == "beacon"]
    assert max(m.residual for m in walled) > 2.0
    for measured in walled:
        here = next(point.position_m for point in ways["ff2"] if point.t == measured.t)
        assert measured.residual == pytest.approx(measured.value - math.dist(here, beacon), abs=0.05)


@pytest.mark.parametrize("node", ["ff1", "beacon", "b10"])
def test_who_has_left_is_held_by_what_held_him(node: str) -> None:
    before = SMOOTHER.evidence(walk(), node)
    after = SMOOTHER.evidence([*walk(), Retire(t=36.0, node=node)], node)
    assert before is not None
    assert after is not None
    assert after.position_m == pytest.approx(before.position_m)
    assert [m.share for m in after.held] == pytest.approx([m.share for m in before.held])


def test_an_unknown_node_has_no_evidence() -> None:
    with pytest.raises(KeyError):
        SMOOTHER.evidence(walk(), "nobody")
    with pytest.raises(KeyError):
        SMOOTHER.advice(walk(), "nobody")


def test_advice_names_the_best_first_and_never_makes_worse() -> None:
    found = SMOOTHER.advice(walk(), "ff2")
    assert found is not None
    gains = [s.gain for s in found.suggestions]
    assert gains
    assert gains == sorted(gains, reverse=True)
    assert all(0.0 < g <= 1.0 for g in gains)
    assert all(s.sigma_m <= found.sigma_m for s in found.suggestions)


def test_while_nothing_but_a_uav_is_known_nothing_can_be_done_for_it() -> None:
    flying = [Position(t=float(t), node="uav", position_m=(1.0 * t, 0.0, 20.0)) for t in range(3)]
    found = SMOOTHER.advice([Node(t=0.0, node="uav", role="uav"), *flying], "uav")
    assert found is not None
    assert found.sigma_m > 0.0
    assert found.suggestions == []


def test_who_is_known_exactly_needs_neither() -> None:
    assert SMOOTHER.evidence(walk(), "base") is None
    assert SMOOTHER.advice(walk(), "base") is None
