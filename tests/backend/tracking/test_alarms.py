"""Alarms stand until a person has acknowledged them and they are cleared, with all that was said."""

import json
from pathlib import Path
from typing import Any

import pytest

from backend.tracking.alarms import REPEAT_S, TEXTS_KEPT
from backend.tracking.board import Board
from estimator.measurements import Alarm
from estimator.measurements.status import AlarmKind, AlarmState

STORIES = json.loads((Path(__file__).parent / "alarm_stories.json").read_text())
LUNAR = "Location: second floor, corridor. Unit: E7. Name: Novak. Assignment: attack. Resources: air."


def shown(*readings: Alarm) -> list[tuple[str, str, float, str | None]]:
    board = Board()
    board.fold(readings)
    return [(a.alarm, a.state, a.t, a.text) for a in board.picture([], 1.0).alarms]


def alarm(state: AlarmState, t: float, kind: AlarmKind = "mayday", text: str | None = None) -> Alarm:
    return Alarm(t=t, node="ff1", alarm=kind, state=state, text=text)


def raised(t: float, kind: AlarmKind = "mayday", text: str | None = None) -> Alarm:
    return alarm("raised", t, kind, text)


def acknowledged(t: float, kind: AlarmKind = "mayday", text: str | None = None) -> Alarm:
    return alarm("acknowledged", t, kind, text)


def cleared(t: float, kind: AlarmKind = "mayday", text: str | None = None) -> Alarm:
    return alarm("cleared", t, kind, text)


def times_of(readings: list[Alarm]) -> list[float]:
    """When the alarm was raised, each time, by what is shown as one reading after the other comes."""
    times: list[float] = []
    for heard in range(1, len(readings) + 1):
        for _, _, t, _ in shown(*readings[:heard]):
            if times and t < times[-1]:
                times[-1] = t  # the call whose answer came first
            elif t not in times:
                times.append(t)
    return times


@pytest.mark.parametrize("story", STORIES, ids=lambda story: str(story["what"]))
def test_an_alarm_is_raised_as_often_as_the_timeline_of_the_screen_marks_it(story: dict[str, Any]) -> None:
    """The screen reads the log by the same rule (`past-alarms.ts`), and is held to the same stories."""
    assert times_of([alarm(state, t, text=text) for state, t, text in story["said"]]) == story["raised"]


def test_a_mayday_stands_until_it_is_acknowledged_and_cleared() -> None:
    call = raised(10.0, text="trapped")
    assert shown(call) == [("mayday", "raised", 10.0, "trapped")]
    assert shown(call, acknowledged(12.0)) == [("mayday", "acknowledged", 10.0, "trapped")]
    assert shown(call, acknowledged(12.0), cleared(13.0)) == []


@pytest.mark.parametrize("kind", ["mayday", "pass", "help"])
def test_a_call_that_the_unit_clears_by_itself_stands_until_a_person_has_acknowledged_it(
    kind: AlarmKind,
) -> None:
    calls = (raised(10.0, kind, "trapped"), cleared(12.0, kind, "switched off"))
    assert shown(*calls) == [(kind, "cleared", 10.0, "trapped\nswitched off")]
    assert shown(*calls, cleared(13.0, kind)) == [(kind, "cleared", 10.0, "trapped\nswitched off")]
    assert shown(*calls, acknowledged(14.0, kind)) == []
    assert shown(*calls, acknowledged(14.0, kind), cleared(14.0, kind)) == []


def test_an_order_to_evacuate_that_is_lifted_is_over() -> None:
    assert shown(raised(10.0, "evacuate"), cleared(12.0, "evacuate")) == []


def test_a_unit_that_calls_again_after_clearing_its_call_has_said_both() -> None:
    assert shown(raised(10.0, text=LUNAR), cleared(12.0), raised(60.0, text="leg broken")) == [
        ("mayday", "raised", 60.0, f"{LUNAR}\nleg broken")
    ]


def test_what_was_said_of_an_alarm_that_is_over_is_not_said_of_the_next() -> None:
    over = (raised(10.0, text=LUNAR), acknowledged(12.0), cleared(13.0))
    assert shown(*over, raised(60.0)) == [("mayday", "raised", 60.0, None)]


def test_who_acknowledges_does_not_wipe_out_where_the_caller_lies() -> None:
    answered = (raised(10.0, text=LUNAR), acknowledged(12.0, text="RIT: E7-1, E7-2"))
    assert shown(*answered) == [("mayday", "acknowledged", 10.0, f"{LUNAR}\nRIT: E7-1, E7-2")]


def test_words_that_are_repeated_are_shown_once() -> None:
    calls = [raised(10.0 + i, text=LUNAR) for i in range(5)]
    assert shown(*calls) == [("mayday", "raised", 10.0, LUNAR)]


def test_of_many_words_the_first_and_the_newest_are_shown() -> None:
    ((_, _, _, text),) = shown(
        raised(10.0, text=LUNAR), *(raised(11.0 + i, text=f"air {99 - i} bar") for i in range(40))
    )
    assert text is not None
    lines = text.split("\n")
    assert (len(lines), lines[0], lines[1], lines[-1]) == (TEXTS_KEPT, LUNAR, "air 66 bar", "air 60 bar")


def test_a_tablet_whose_clock_is_behind_can_acknowledge() -> None:
    assert shown(raised(1000.0), acknowledged(10.0)) == [("mayday", "acknowledged", 1000.0, None)]


def test_a_node_may_have_several_alarms_the_oldest_first() -> None:
    assert shown(raised(11.0, "help"), raised(10.0, "pass"), raised(12.0)) == [
        ("pass", "raised", 10.0, None),
        ("help", "raised", 11.0, None),
        ("mayday", "raised", 12.0, None),
    ]


def test_a_unit_that_keeps_sounding_does_not_undo_the_acknowledgement() -> None:
    sounding = [raised(10.0 + i, "pass") for i in range(5)]
    more = [raised(15.0 + i, "pass") for i in range(50)]
    assert shown(*sounding, acknowledged(15.0, "pass"), *more) == [("pass", "acknowledged", 10.0, None)]
    assert shown(*sounding, acknowledged(15.0, "pass"), *more, cleared(70.0, "pass")) == []


def test_a_new_call_after_silence_or_with_new_words_is_a_new_alarm() -> None:
    answered = (raised(10.0, text="trapped"), acknowledged(12.0))
    later = raised(11.0 + REPEAT_S + 10.0)
    assert shown(*answered, later) == [("mayday", "raised", later.t, "trapped")]
    assert shown(*answered, later, cleared(later.t + 1.0)) == [("mayday", "cleared", later.t, "trapped")]
    assert shown(*answered, raised(13.0, text="low air")) == [("mayday", "raised", 13.0, "trapped\nlow air")]


def test_an_alarm_that_comes_again_by_another_way_stays_over() -> None:
    call, over = raised(10.0), (acknowledged(11.0), cleared(12.0))
    assert shown(call, *over, call) == []
    assert shown(call, *over, raised(13.0)) == [("mayday", "raised", 13.0, None)]


def test_a_call_of_a_unit_whose_clock_was_put_back_since_its_last_one_is_a_new_alarm() -> None:
    over = (raised(1000.0, text=LUNAR), acknowledged(1010.0), cleared(1020.0))
    assert shown(*over, raised(5.0)) == [("mayday", "raised", 5.0, None)]
    assert shown(*over[:2], raised(5.0)) == [("mayday", "raised", 5.0, LUNAR)]
    again = (raised(5.0), acknowledged(1100.0), cleared(1110.0))
    assert shown(*over, *again, raised(1000.0), raised(5.0)) == [], "both come again by another way"
    assert shown(*over, *again, raised(60.0)) == [("mayday", "raised", 60.0, None)]
    assert shown(over[0], raised(5.0)) == [("mayday", "raised", 1000.0, LUNAR)], "not answered"


def test_an_acknowledgement_that_comes_after_the_alarm_is_over_opens_nothing() -> None:
    assert shown(raised(10.0), acknowledged(11.0), cleared(12.0), acknowledged(13.0)) == []


def test_an_acknowledgement_of_an_alarm_that_was_never_heard_shows_it() -> None:
    assert shown(acknowledged(5.0)) == [("mayday", "acknowledged", 5.0, None)]


def test_an_answer_that_overtakes_the_call_leaves_the_call_standing() -> None:
    assert shown(cleared(12.0)) == []
    assert shown(cleared(12.0), raised(10.0, text=LUNAR)) == [("mayday", "cleared", 10.0, LUNAR)]
    assert shown(acknowledged(12.0), raised(10.0, text=LUNAR)) == [("mayday", "acknowledged", 10.0, LUNAR)]
    assert shown(acknowledged(12.0), cleared(13.0), raised(10.0)) == []
