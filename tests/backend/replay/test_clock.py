"""The time of a replay."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.replay.clock import ReplayClock
from backend.replay.control import FASTEST, SLOWEST, apply, understand


def test_time_goes_as_fast_as_is_asked_and_stops_at_the_end() -> None:
    clock = ReplayClock(100.0, 200.0, 4.0, wall_s=0.0)
    assert [clock.now(s) for s in (0.0, 1.0, 10.0, 25.0, 1000.0)] == [100.0, 104.0, 140.0, 200.0, 200.0]
    assert (clock.ended(24.9), clock.ended(25.0)) == (False, True)


def test_a_seek_goes_on_from_there_even_after_the_end() -> None:
    clock = ReplayClock(100.0, 200.0, 1.0, wall_s=0.0)
    assert clock.ended(500.0)
    clock.seek(150.0, 500.0)
    assert (clock.now(500.0), clock.now(510.0), clock.ended(510.0)) == (150.0, 160.0, False)


def test_a_seek_beyond_an_end_goes_to_that_end() -> None:
    clock = ReplayClock(100.0, 200.0, 1.0, wall_s=0.0)
    clock.seek(0.0, 0.0)
    assert clock.now(0.0) == 100.0
    clock.seek(1e9, 0.0)
    assert clock.now(0.0) == 200.0


def test_a_pause_holds_time_and_a_change_of_speed_does_not_jump() -> None:
    clock = ReplayClock(0.0, 1000.0, 1.0, wall_s=0.0)
    clock.pause(True, 10.0)
    assert clock.now(100.0) == 10.0
    clock.seek(50.0, 100.0)
    assert clock.now(200.0) == 50.0
    clock.pause(False, 200.0)
    clock.go(8.0, 201.0)
    assert (clock.now(201.0), clock.now(202.0)) == (51.0, 59.0)


@given(st.lists(st.tuples(st.sampled_from(["seek", "speed", "pause"]), st.floats(0.0, 300.0)), max_size=20))
def test_time_is_never_outside_the_replay_and_only_a_seek_takes_it_back(
    acts: list[tuple[str, float]],
) -> None:
    clock = ReplayClock(100.0, 200.0, 1.0, wall_s=0.0)
    wall_s, before = 0.0, 100.0
    for act, value in acts:
        wall_s += value / 10.0
        reached = clock.now(wall_s)
        assert before <= reached <= 200.0
        if act == "seek":
            clock.seek(value, wall_s)
        elif act == "speed":
            clock.go(max(SLOWEST, value / 10.0), wall_s)
        else:
            clock.pause(value > 150.0, wall_s)
        before = clock.now(wall_s)
        assert 100.0 <= before <= 200.0
        assert act == "seek" or before == pytest.approx(reached)


@pytest.mark.parametrize(
    "message",
    [
        "",
        "go",
        "[]",
        "{}",
        '{"seek": "noon"}',
        '{"seek": NaN}',
        '{"seek": 1e999}',
        '{"seek": -1}',
        '{"speed": 0}',
        '{"speed": -2}',
        f'{{"speed": {FASTEST * 2}}}',
        '{"pause": 1}',
        '{"rewind": true}',
        b"\xff\xfe",
        "[" * 5000,
    ],
)
def test_what_is_no_control_is_refused_with_what_to_send(message: str | bytes) -> None:
    with pytest.raises(ValueError, match="send"):
        understand(message)


def test_several_controls_may_come_at_once() -> None:
    clock = ReplayClock(100.0, 200.0, 1.0, wall_s=0.0)
    apply(understand('{"seek": 150, "speed": 2, "pause": true}'), clock, 5.0)
    assert (clock.now(99.0), clock.speed, clock.paused) == (150.0, 2.0, True)
