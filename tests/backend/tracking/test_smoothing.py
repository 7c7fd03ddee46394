"""Sums that are kept by what was asked."""

import asyncio
import multiprocessing

import msgspec
import pytest

from backend.errors import NotFound, TooSlow
from backend.tracking import smoothing
from backend.tracking.aside import smooth_log
from backend.tracking.heads import Head
from backend.tracking.smoothing import Kept, Smoothing
from estimator.trackers.base import TrackerSettings


class Counted:
    """A sum that counts how often it was begun, and ends when it is told to."""

    def __init__(self, *, done: bool = True, fails: bool = False) -> None:
        self.begun = 0
        self.fails = fails
        self.end = asyncio.Event()
        if done:
            self.end.set()

    async def __call__(self) -> int:
        self.begun += 1
        await self.end.wait()
        if self.fails:
            raise ValueError("no")
        return self.begun


def test_asking_twice_begins_once() -> None:
    async def ask() -> None:
        kept, slow = Kept[int](2), Counted(done=False)
        asked = [asyncio.create_task(kept.get("a", slow, 5.0, "This")) for _ in range(3)]
        await asyncio.sleep(0)
        slow.end.set()
        assert await asyncio.gather(*asked) == [1, 1, 1]
        assert await kept.get("a", slow, 5.0, "This") == 1

    asyncio.run(ask())


def test_what_failed_is_begun_again() -> None:
    async def ask() -> None:
        kept, failing = Kept[int](2), Counted(fails=True)
        for _ in range(2):
            with pytest.raises(ValueError, match="no"):
                await kept.get("a", failing, 5.0, "This")
        assert failing.begun == 2

    asyncio.run(ask())


def test_what_takes_long_goes_on_and_is_found_done() -> None:
    async def ask() -> None:
        kept, slow = Kept[int](2), Counted(done=False)
        with pytest.raises(TooSlow, match=r"This takes longer than 0\.01 s; it goes on"):
            await kept.get("a", slow, 0.01, "This")
        slow.end.set()
        assert await kept.get("a", slow, 5.0, "This") == 1

    asyncio.run(ask())


def test_of_an_incident_without_readings_nobody_waits_for_the_process() -> None:
    head = Head(
        incident="new", tracker="kirchhoff", settings=TrackerSettings(), last_seq=0, closed=False, live=True
    )

    async def ask() -> None:
        aside = Smoothing("sqlite:///not/there.db")
        for asked in (
            aside.relative(head, "ff1", "ff2"),
            aside.evidence(head, "ff1", None),
            aside.advice(head, "ff1"),
        ):
            with pytest.raises(NotFound, match="No reading of this incident"):
                await asked

    asyncio.run(ask())


def test_who_waits_for_what_was_given_up_is_told_so() -> None:
    async def ask() -> None:
        kept, slow = Kept[int](1), Counted(done=False)
        waiting = asyncio.create_task(kept.get("a", slow, 5.0, "This"))
        await asyncio.sleep(0)
        assert await kept.get("b", Counted(), 5.0, "That") == 1
        with pytest.raises(TooSlow, match="in the way"):
            await waiting

    asyncio.run(ask())


def test_a_request_that_is_given_up_ends_without_ending_the_sum() -> None:
    async def ask() -> None:
        kept, slow = Kept[int](1), Counted(done=False)
        waiting = asyncio.create_task(kept.get("a", slow, 5.0, "This"))
        await asyncio.sleep(0)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        slow.end.set()
        assert await kept.get("a", slow, 5.0, "This") == 1
        assert slow.begun == 1

    asyncio.run(ask())


def test_the_sums_that_were_asked_for_longest_ago_are_given_up_first() -> None:
    async def ask() -> None:
        kept, sums = Kept[int](2), {name: Counted() for name in "abc"}
        for name in "abaca":
            await kept.get(name, sums[name], 5.0, "This")
        assert {name: counted.begun for name, counted in sums.items()} == {"a": 1, "b": 1, "c": 1}
        await kept.get("b", sums["b"], 5.0, "This")
        assert sums["b"].begun == 2

    asyncio.run(ask())


def test_the_process_is_there_before_anybody_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(smoothing, "PREPARED_AFTER_S", 0.0)

    async def begins_and_ends() -> None:
        aside = Smoothing("sqlite://")
        await aside.start()
        (process,) = multiprocessing.active_children()
        assert process.is_alive()
        aside.close()
        # The pool waits for its end too: whoever is told second cannot tell at once.
        for _ in range(100):
            if not process.is_alive():
                break
            await asyncio.sleep(0.1)
        assert not process.is_alive()

    asyncio.run(begins_and_ends())


def test_who_ends_before_it_is_prepared_starts_no_process() -> None:
    async def begins_and_ends() -> None:
        aside = Smoothing("sqlite://")
        aside.start()
        await asyncio.sleep(0)
        aside.close()
        await asyncio.sleep(0)
        assert not multiprocessing.active_children()

    asyncio.run(begins_and_ends())


def test_what_one_tracker_said_is_not_told_of_another(monkeypatch: pytest.MonkeyPatch) -> None:
    async def in_this_process(_: Smoothing, function: object, _url: str, head: Head, *__: object) -> object:
        return msgspec.msgpack.encode({head.tracker: []}) if function is smooth_log else head.tracker

    monkeypatch.setattr(Smoothing, "_aside", in_this_process)

    async def ask() -> None:
        aside = Smoothing("sqlite://")
        for tracker in ("paper-a", "kirchhoff"):
            head = Head(
                incident="i",
                closed=False,
                last_seq=1,
                tracker=tracker,
                settings=TrackerSettings(),
                live=False,
            )
            assert await aside.smoothed(head) == {tracker: []}
            told: list[object] = [await aside.evidence(head, "ff1", None), await aside.advice(head, "ff1")]
            assert told == [tracker, tracker]

    asyncio.run(ask())
