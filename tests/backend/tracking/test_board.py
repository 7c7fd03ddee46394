"""What is shown but not fused."""

from backend.live.record import PictureRecord, RecordAlarm
from backend.tracking.board import NOTICES_KEPT, Board
from estimator.estimate import NodeEstimate, Notice
from estimator.measurements import Alarm, AnyReading, Node, Range, Retire, Status


def board(*readings: AnyReading) -> Board:
    made = Board()
    made.fold(readings)
    return made


def picture(made: Board, *nodes: str) -> PictureRecord:
    return made.picture([NodeEstimate(node=node, role="responder", t=1.0) for node in nodes], 1.0)


def test_names_stay_until_they_are_changed() -> None:
    made = board(
        Node(t=1.0, node="ff1", role="responder", callsign="E7-1", crew="E7"),
        Node(t=2.0, node="ff1", role="responder", callsign="E7-2"),
    )
    (node,) = picture(made, "ff1").nodes
    assert (node.callsign, node.crew) == ("E7-2", "E7")


def test_each_vital_sign_is_the_newest_that_was_reported() -> None:
    made = board(
        Status(t=10.0, node="ff1", battery=0.9, air_bar=200.0),
        Status(t=20.0, node="ff1", air_bar=150.0, temperature_c=40.0),
        Status(t=15.0, node="ff1", air_bar=180.0, motionless_s=9.0),
    )
    (node,) = picture(made, "ff1").nodes
    assert (node.battery, node.air_bar, node.temperature_c, node.motionless_s) == (0.9, 150.0, 40.0, None)


def test_each_vital_sign_has_the_age_of_its_own_report() -> None:
    made = board(
        Status(t=10.0, node="ff1", battery=0.9, air_bar=200.0),
        Status(t=500.0, node="ff1", battery=0.8),
    )
    (node,) = picture(made, "ff1").nodes
    assert (node.battery_t, node.air_t, node.temperature_t, node.motionless_t) == (500.0, 10.0, None, None)


def test_air_is_that_of_the_cylinder_in_use() -> None:
    def cylinder(*reported_bar: float) -> tuple[float | None, float | None]:
        told = [Status(t=float(at), node="ff1", air_bar=bar) for at, bar in enumerate(reported_bar)]
        (node,) = picture(board(*told), "ff1").nodes
        return node.air_first_bar, node.air_least_bar

    assert cylinder() == (None, None)
    assert cylinder(298.0, 301.0, 240.0, 238.0, 241.0) == (301.0, 238.0)
    assert cylinder(300.0, 58.0, 61.0) == (300.0, 58.0)
    assert cylinder(300.0, 55.0, 290.0, 280.0) == (290.0, 280.0)


def test_who_raises_an_alarm_is_shown_even_if_the_tracker_does_not_know_of_it() -> None:
    made = picture(board(Alarm(t=10.0, node="ff1", alarm="mayday", state="raised")))
    assert [(node.node, node.role, node.t, node.position_m) for node in made.nodes] == [
        ("ff1", "responder", 10.0, None)
    ]
    assert made.alarms == (RecordAlarm(node="ff1", alarm="mayday", state="raised", t=10.0),)


def test_a_notice_replaces_the_last_of_its_kind_and_node_and_few_are_kept() -> None:
    made = Board()
    made.notice(
        [
            Notice(code="outlier", t=1.0, node="ff1", text="one"),
            Notice(code="outlier", t=2.0, node="ff2", text="x"),
        ]
    )
    made.notice([Notice(code="outlier", t=3.0, node="ff1", text="two")])
    assert [(n.node, n.text) for n in picture(made).notices] == [("ff2", "x"), ("ff1", "two")]
    made.notice([Notice(code="outlier", t=4.0, node=f"n{i}", text="many") for i in range(100)])
    assert len(picture(made).notices) == NOTICES_KEPT


def test_a_moved_breadcrumb_keeps_when_it_was_noticed() -> None:
    made = Board()
    made.notice([Notice(code="node_moved", t=7.0, node="bc1", text="moved")])
    assert picture(made, "bc1").nodes[0].moved_t == 7.0


def test_other_readings_leave_no_trace() -> None:
    assert board(Range(t=1.0, a="ff1", b="bc1", range_m=1.0)) == Board()


def test_why_somebody_was_retired_is_kept_as_it_was_last_said_and_told_of_nobody_who_is_there() -> None:
    made = board(
        Retire(t=5.0, node="ff1", reason="unit burned"),
        Retire(t=3.0, node="ff1", reason="came late"),
        Retire(t=5.0, node="unheard", reason="never there"),
    )
    gone = NodeEstimate(node="ff1", role="responder", t=5.0, retired=True)
    there = NodeEstimate(node="ff1", role="responder", t=6.0)
    assert [node.retire_reason for node in made.picture([gone], 5.0).nodes] == ["unit burned"]
    assert [node.retire_reason for node in made.picture([there], 6.0).nodes] == [None]
    made.fold([Retire(t=8.0, node="ff1")])
    assert made.picture([gone], 8.0).nodes[0].retire_reason is None
