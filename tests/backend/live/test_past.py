"""A frame of the past is shown by what was set then."""

from collections.abc import Callable
from functools import partial

import pytest

from backend.live.past import told_at
from backend.log.base import RecordedFrame
from backend.log.incident import Incident, IncidentSettings, Level, Stretch

Make = Callable[..., Incident]

GROUND = Level(level=0, name="G", up_m=0.0)


def stretch(after_seq: int, since: float, stale_after_s: float, *levels: Level) -> Stretch:
    settings = IncidentSettings(stale_after_s=stale_after_s)
    return Stretch(after_seq=after_seq, since=since, origin=None, levels=list(levels), settings=settings)


@pytest.fixture
def changed_twice(incident: Make) -> Make:
    """An incident that was set otherwise twice after entry 7; what holds now is the last."""
    stretches = [stretch(0, 100.0, 10.0), stretch(7, 200.0, 20.0), stretch(7, 210.0, 30.0, GROUND)]
    now = {"levels": stretches[-1].levels, "settings": stretches[-1].settings}
    return partial(incident, stretches=stretches, **now)


def row(seq: int, received: float) -> RecordedFrame:
    return RecordedFrame(second=1, seq=seq, received=received, record=b"")


@pytest.mark.parametrize(
    ("t", "stale_after_s"), [(50.0, 10), (199.9, 10), (200.0, 20), (209.9, 20), (210.0, 30)]
)
def test_by_the_servers_clock_settings_hold_from_the_moment_at_which_they_were_made(
    changed_twice: Make, t: float, stale_after_s: float
) -> None:
    told = told_at(changed_twice(clock="live"), t)
    assert told.settings.stale_after_s == stale_after_s
    assert bool(told.levels) == (stale_after_s == 30)


@pytest.mark.parametrize(
    ("standing", "stale_after_s"),
    [
        (None, 10),
        (row(6, 199.0), 10),
        (row(7, 199.0), 10),
        (row(7, 200.0), 20),
        (row(7, 210.0), 30),
        (row(8, 5.0), 30),
    ],
)
def test_where_readings_are_the_clock_settings_hold_for_what_was_folded_after_them(
    changed_twice: Make, standing: RecordedFrame | None, stale_after_s: float
) -> None:
    told = told_at(changed_twice(clock="recorded"), 1.0, standing)
    assert told.settings.stale_after_s == stale_after_s


def test_now_is_what_was_set_last(changed_twice: Make) -> None:
    now = changed_twice(clock="live")
    assert told_at(now, 1e9) == now
