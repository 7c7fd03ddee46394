"""A picture ages by itself."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from backend.live.presentation import covariance_at, now_of, present, status_of
from backend.live.record import (
    EMPTY,
    PictureRecord,
    RecordAlarm,
    RecordAside,
    RecordClock,
    RecordNode,
    RecordNotice,
)
from backend.log.incident import Incident, IncidentSettings
from estimator.measurements.node import Role

ROLES: list[Role] = ["base", "anchor", "beacon", "breadcrumb", "responder", "uav"]
ORDER = ["live", "stale", "lost"]
Make = Callable[..., Incident]

ages = st.floats(0.0, 1e6)
roots = st.lists(st.floats(-30.0, 30.0), min_size=9, max_size=9)


def responder(**fields: Any) -> RecordNode:
    known: dict[str, Any] = {
        "node": "ff1",
        "role": "responder",
        "t": 100.0,
        "position_m": (1.0, 2.0, 3.1),
        "covariance_m2": (1.0, 0.2, 0.0, 0.9, 0.0, 0.4),
    }
    return RecordNode(**(known | fields))


def matrix(upper: tuple[float, ...]) -> NDArray[np.float64]:
    ee, en, eu, nn, nu, uu = upper
    return np.array([[ee, en, eu], [en, nn, nu], [eu, nu, uu]])


def test_a_responder_is_live_then_stale_then_lost() -> None:
    settings = IncidentSettings()
    at = {age: status_of("responder", age, settings, retired=False) for age in (0.0, 10.0, 10.1, 60.0, 60.1)}
    assert at == {0.0: "live", 10.0: "live", 10.1: "stale", 60.0: "stale", 60.1: "lost"}


def test_who_is_of_the_future_since_the_clock_was_put_back_is_not_called_live(incident: Make) -> None:
    shown = present(PictureRecord(t=3700.0, nodes=(responder(t=3700.0),)), 1, 100.0, incident()).nodes[0]
    assert shown.status == "lost"
    assert shown.covariance_m2 is not None
    assert shown.covariance_m2[0] > 1000.0**2


def test_a_breadcrumb_is_given_more_time_than_a_responder() -> None:
    settings = IncidentSettings()
    assert status_of("breadcrumb", 59.0, settings, retired=False) == "live"
    assert status_of("breadcrumb", 61.0, settings, retired=False) == "stale"
    assert status_of("breadcrumb", 301.0, settings, retired=False) == "lost"


def test_the_base_stays_live_and_who_left_stays_retired() -> None:
    settings = IncidentSettings()
    assert status_of("base", 1e6, settings, retired=False) == "live"
    assert status_of("responder", 0.0, settings, retired=True) == "retired"


def test_an_incident_may_set_its_own_limits() -> None:
    settings = IncidentSettings(stale_after_s=2.0, lost_after_s=4.0)
    assert status_of("uav", 3.0, settings, retired=False) == "stale"
    assert status_of("uav", 5.0, settings, retired=False) == "lost"


@given(st.sampled_from(ROLES), ages, ages)
def test_no_node_gets_better_by_getting_older(role: Role, one: float, other: float) -> None:
    younger, older = sorted((one, other))
    settings = IncidentSettings()
    before = status_of(role, younger, settings, retired=False)
    after = status_of(role, older, settings, retired=False)
    assert ORDER.index(before) <= ORDER.index(after)


@given(roots, st.sampled_from(ROLES), ages, ages)
def test_uncertainty_never_shrinks_with_age_and_stays_a_covariance(
    root: list[float], role: Role, one: float, other: float
) -> None:
    factor = np.array(root).reshape(3, 3)
    full = factor @ factor.T
    upper = tuple(float(full[i, j]) for i in range(3) for j in range(i, 3))
    known = responder(role=role, covariance_m2=upper, t=0.0)
    younger, older = sorted((one, other))
    before, after = covariance_at(known, younger), covariance_at(known, older)
    assert before is not None
    assert after is not None
    tolerance = 1e-9 * (1.0 + abs(full).max() + older**2)
    assert np.linalg.eigvalsh(matrix(after)).min() >= -tolerance
    assert np.linalg.eigvalsh(matrix(after) - matrix(before)).min() >= -tolerance


def test_a_fix_of_the_last_second_is_shown_as_the_estimator_gave_it() -> None:
    known = responder()
    assert covariance_at(known, 101.0) == known.covariance_m2


def test_who_may_have_walked_on_is_less_certain_and_stays_at_the_last_fix(incident: Make) -> None:
    frame = present(PictureRecord(t=100.0, nodes=(responder(),)), 7, 120.0, incident())
    (node,) = frame.nodes
    assert node.position_m == (1.0, 2.0, 3.1)
    assert node.covariance_m2 == pytest.approx((101.0, 0.2, 0.0, 100.9, 0.0, 4.4))
    assert (node.status, node.t, frame.seq, frame.t) == ("stale", 100.0, 7, 120.0)


def test_a_breadcrumb_does_not_walk(incident: Make) -> None:
    known = responder(role="breadcrumb")
    (node,) = present(PictureRecord(t=100.0, nodes=(known,)), 1, 500.0, incident()).nodes
    assert node.covariance_m2 == known.covariance_m2


def test_a_storey_becomes_less_sure_with_age(incident: Make) -> None:
    record = PictureRecord(t=100.0, nodes=(responder(),))
    (fresh,) = present(record, 1, 100.0, incident()).nodes
    (old,) = present(record, 1, 160.0, incident()).nodes
    assert fresh.level == old.level == 1
    assert fresh.level_p is not None
    assert old.level_p is not None
    assert 0.5 < old.level_p < fresh.level_p < 1.0


def test_without_named_storeys_no_storey_is_told(incident: Make) -> None:
    (node,) = present(PictureRecord(t=100.0, nodes=(responder(),)), 1, 100.0, incident(levels=[])).nodes
    assert (node.level, node.level_p) == (None, None)


def test_a_node_without_a_place_is_shown_without_one(incident: Make) -> None:
    known = responder(position_m=None, covariance_m2=None)
    (node,) = present(PictureRecord(t=100.0, nodes=(known,)), 1, 130.0, incident()).nodes
    assert (node.position_m, node.covariance_m2, node.level, node.status) == (None, None, None, "stale")


def test_alarms_and_notices_are_shown(incident: Make) -> None:
    alarm = RecordAlarm(node="ff1", alarm="mayday", state="raised", t=99.0, text="trapped")
    notices = tuple(RecordNotice(code="not_fused", t=float(i), text="imu", node=f"ff{i}") for i in range(20))
    frame = present(PictureRecord(t=100.0, alarms=(alarm,), notices=notices), 1, 100.0, incident())
    assert [(a.node, a.alarm, a.state, a.t, a.text) for a in frame.alarms] == [
        ("ff1", "mayday", "raised", 99.0, "trapped")
    ]
    assert [notice.node for notice in frame.notices] == [f"ff{i}" for i in range(12, 20)]


@pytest.mark.parametrize("code", ["too_late", "no_origin"])
def test_why_somebody_has_no_place_is_told_however_much_else_is_noticed(incident: Make, code: str) -> None:
    late = RecordNotice(code=code, t=1.0, text="late", node="ff1")
    others = tuple(RecordNotice(code="echo", t=2.0, text="echo", node=f"b{at}") for at in range(20))

    def told(*nodes: RecordNode) -> set[str | None]:
        record = PictureRecord(t=100.0, nodes=nodes, notices=(late, *others))
        return {notice.node for notice in present(record, 1, 100.0, incident()).notices}

    assert "ff1" in told()
    assert "ff1" in told(responder(position_m=None, covariance_m2=None))
    assert "ff1" not in told(responder())


def test_who_is_set_aside_is_told_from_then_on_unless_live_on_the_map_or_gone(incident: Make) -> None:
    aside = RecordAside(
        name="ff1", gateway="g", since_t=150.0, t=160.0, code="time_in_future", text="clock ahead"
    )

    def told(now: float, *nodes: RecordNode) -> list[tuple[str, float]]:
        record = PictureRecord(t=100.0, nodes=nodes, set_aside=(aside,))
        return [(known.name, known.t) for known in present(record, 1, now, incident()).set_aside]

    assert told(149.0) == []
    assert told(155.0) == [("ff1", 155.0)]
    assert told(500.0) == [("ff1", 160.0)]
    assert told(170.0, responder(t=165.0)) == []
    assert told(170.0, responder(t=165.0, position_m=None, covariance_m2=None)) == [("ff1", 160.0)]
    assert told(170.0, responder(t=100.0)) == [("ff1", 160.0)]
    assert told(170.0, responder(t=100.0, retired=True)) == []


def test_air_is_low_where_the_whistle_sounds_and_half_used_on_the_way_there(incident: Make) -> None:
    def air(now: Incident, **fields: Any) -> tuple[str | None, float | None]:
        (node,) = present(PictureRecord(t=100.0, nodes=(responder(**fields),)), 1, 100.0, now).nodes
        return node.air_state, node.air_turn_back_bar

    usual, american = incident(), incident(settings=IncidentSettings(low_air_bar=103.0))
    assert air(usual) == (None, None)
    assert air(usual, air_first_bar=300.0, air_least_bar=181.0) == (None, 180.0)
    assert air(usual, air_first_bar=300.0, air_least_bar=180.0) == ("turn_back", 180.0)
    assert air(usual, air_first_bar=300.0, air_least_bar=61.0) == ("turn_back", 180.0)
    assert air(usual, air_first_bar=300.0, air_least_bar=60.0) == ("low", 180.0)
    assert air(usual, air_first_bar=50.0, air_least_bar=50.0) == ("low", 60.0)
    assert air(usual, air_first_bar=300.0, air_least_bar=60.0, retired=True) == (None, 180.0)
    assert air(american, air_first_bar=310.0, air_least_bar=103.0) == ("low", 206.5)


def test_a_moved_breadcrumb_is_flagged_for_ten_minutes(incident: Make) -> None:
    record = PictureRecord(t=100.0, nodes=(responder(role="breadcrumb", moved_t=100.0),))
    assert present(record, 1, 699.0, incident()).nodes[0].moved
    assert not present(record, 1, 701.0, incident()).nodes[0].moved


def test_now_is_the_servers_clock_or_the_newest_reading(incident: Make) -> None:
    record = PictureRecord(t=100.0)
    assert now_of(incident(), record, 500.0) == 500.0
    assert now_of(incident(clock="recorded"), record, 500.0) == 100.0
    assert now_of(incident(clock="recorded"), EMPTY, 500.0) == 0.0
    assert now_of(incident(state="closed", closed=200.0), record, 500.0) == 200.0
    assert not math.isnan(now_of(incident(), EMPTY, 0.0))


def test_a_clock_that_is_behind_is_told_while_its_gateway_is_heard(incident: Make) -> None:
    clock = RecordClock(gateway="engine-7", t=150.0, behind_s=3600.0, clock_of="gateway")
    record = PictureRecord(t=100.0, clocks=(clock,))

    def told(now: float) -> list[tuple[str, float]]:
        return [(known.gateway, known.behind_s) for known in present(record, 1, now, incident()).clocks]

    assert told(151.0) == [("engine-7", 3600.0)]
    assert told(149.0) == []
    assert told(150.0 + incident().settings.lost_after_s + 1) == []
