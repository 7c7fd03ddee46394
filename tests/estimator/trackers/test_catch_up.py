"""A gateway that is always far behind: what is shown keeps up, and is a function of the log all the same."""

from collections.abc import Iterator

import pytest

from estimator.estimate import NodeEstimate
from estimator.fusion.memory.state import FusionState
from estimator.measurements import AnyReading
from estimator.smoothing.images.flip_ambiguity import HURRIED, LIVE, Effort
from estimator.smoothing.window_solution import refresh
from estimator.trackers.catch_up import (
    BACKLOG_TICKS,
    FOLLOWED_PER_TICK,
    PROMPT_TICKS,
    REFOLDED_PER_TICK,
    CatchUp,
)
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.walks import two_responders

BEHIND_S, LAST_S = 40, 100
WALK = two_responders(LAST_S + 60)
Picture = list[NodeEstimate]


def of_the_second(second: int, *, behind: bool) -> list[AnyReading]:
    """What a gateway has measured in a second: the one behind bears ff2, who has no unit."""
    mine = [r for r in WALK if ("ff2" in (getattr(r, "node", ""), getattr(r, "a", ""))) == behind]
    return [r for r in mine if second - 1 < r.t <= second]


def batches(last_s: int = LAST_S) -> Iterator[list[AnyReading]]:
    """A batch of each gateway a second, until both have posted all up to `last_s`."""
    for second in range(last_s + BEHIND_S + 1):
        yield of_the_second(second, behind=False) if second <= last_s else []
        yield of_the_second(second - BEHIND_S, behind=True)


def test_a_gateway_that_is_always_behind_has_the_window_solved_a_few_times_a_second_at_most(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    solved: list[float] = []

    def counted(state: FusionState, solved_t: float, bent: bool = False, effort: Effort = LIVE) -> bool:
        solved.append(state.newest_t)
        return refresh(state, solved_t, bent, effort)

    monkeypatch.setattr("estimator.smoothing.window.refresh", counted)
    tracker, before = KirchhoffTracker(), 0
    for number, batch in enumerate(batches(LAST_S)):
        if number == 2 * (BEHIND_S + 10):
            before = len(solved)
        if number == 2 * LAST_S:
            break
        tracker.fold(batch)
        tracker.estimates()
    assert (len(solved) - before) / (LAST_S - BEHIND_S - 10) < 4.0


def test_in_a_hurry_images_are_asked_about_less_and_of_the_sure_chain_as_ever(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[float, Effort]] = []

    def noted(state: FusionState, solved_t: float, bent: bool = False, effort: Effort = LIVE) -> bool:
        asked.append((state.newest_t, effort))
        return refresh(state, solved_t, bent, effort)

    monkeypatch.setattr("estimator.smoothing.window.refresh", noted)
    tracker, in_a_hurry, on_time = KirchhoffTracker(), list[float](), list[float]()
    for number, batch in enumerate(batches(60)):
        tracker.fold(batch)
        tracker.estimates()
        newest_t = number // 2
        if number == 2 * BEHIND_S - 1:
            # Until now nothing has come late.
            assert not in_a_hurry
            assert on_time
            on_time.clear()
        in_a_hurry += [newest_t - t for t, effort in asked if effort == HURRIED]
        on_time += [newest_t - t for t, effort in asked if effort == LIVE]
        asked.clear()
        if number == 2 * 60:
            break
    assert max(in_a_hurry) <= PROMPT_TICKS + 1.0 < max(on_time)
    assert tracker.settled() is not None
    assert {effort for _, effort in asked} == {LIVE}


def test_what_is_told_hangs_neither_on_what_was_asked_nor_on_restarts() -> None:
    rarely, often, killed = KirchhoffTracker(), KirchhoffTracker(), KirchhoffTracker()
    hurried = 0
    for number, batch in enumerate(batches(70)):
        for reading in batch:
            often.fold([reading])
        often.estimates()
        if number % 5 == 0:
            often.settled()
        elif number % 5 == 3:
            often.settle()
        for tracker in (rarely, killed):
            tracker.fold(batch)
        if number % 9 == 4:
            killed = KirchhoffTracker.restore(killed.snapshot())
        if number % 26 == 25:
            assert rarely.estimates() == often.estimates() == killed.estimates()
            assert rarely.take_notices() == often.take_notices() == killed.take_notices()
            hurried += rarely.settled() is not None
    assert hurried >= 2


def test_once_nothing_is_late_any_more_all_is_as_if_nothing_had_been() -> None:
    late, in_time = KirchhoffTracker(), KirchhoffTracker()
    for batch in batches(60):
        late.fold(batch)
        late.estimates()
    assert late.settled() is not None
    for second in range(61):
        for behind in (True, False):
            in_time.fold(of_the_second(second, behind=behind))
    settled = late.settled()
    assert settled is not None
    assert settled.estimates() == in_time.estimates()
    for second in range(61, LAST_S + 60):
        for tracker in (late, in_time):
            for behind in (True, False):
                tracker.fold(of_the_second(second, behind=behind))
    assert late.settled() is None
    assert not late.settle()
    assert late.estimates() == in_time.estimates()


def test_what_is_settled_step_by_step_is_what_is_settled_at_once_whatever_comes_between() -> None:
    stepwise, at_once = KirchhoffTracker(), KirchhoffTracker()
    *most, before, last = batches(60)
    for batch in [*most, before]:
        for tracker in (stepwise, at_once):
            tracker.fold(batch)
    assert stepwise.settle()
    assert stepwise.settle()
    for tracker in (stepwise, at_once):
        tracker.fold(last)
    steps = 1
    while stepwise.settle():
        steps += 1
    assert steps > 10
    told, expected = stepwise.settled(), at_once.settled()
    assert told is not None
    assert expected is not None
    assert told.estimates() == expected.estimates()


def hurry_after(lateness: list[int]) -> CatchUp:
    """A tick goes by after each of these, and then something comes so late; 0: nothing does."""
    hurry = CatchUp()
    hurry.advance(1000, 1000)
    for now, late in enumerate(lateness, start=1001):
        hurry.advance(now, now)
        if late:
            hurry.note_reading(now - late, now)
    return hurry


@pytest.mark.parametrize(
    "lateness",
    [
        [PROMPT_TICKS - 1] * 600,
        [REFOLDED_PER_TICK] * 600,
        [BACKLOG_TICKS],
        [BACKLOG_TICKS] + [0] * (BACKLOG_TICKS // REFOLDED_PER_TICK) + [BACKLOG_TICKS],
        [PROMPT_TICKS + 1, 0] * 300,
    ],
)
def test_what_is_late_now_and_then_or_by_little_is_folded_as_it_should_be(lateness: list[int]) -> None:
    assert not hurry_after(lateness).hurrying


@pytest.mark.parametrize(
    "lateness", [[2 * BACKLOG_TICKS], [BACKLOG_TICKS, BACKLOG_TICKS], [50] * 3, [2 * REFOLDED_PER_TICK] * 60]
)
def test_what_goes_on_coming_late_is_folded_in_a_hurry(lateness: list[int]) -> None:
    assert hurry_after(lateness).hurrying


def test_the_sure_chain_stays_behind_what_comes_late_and_catches_up_afterwards() -> None:
    steady = hurry_after([50] * 600)
    assert steady.front == 1600 - 51
    following = 50 // (FOLLOWED_PER_TICK - 1) + 1
    assert hurry_after([50] * 600 + [0] * (following - 3)).hurrying
    assert not hurry_after([50] * 600 + [0] * following).hurrying
