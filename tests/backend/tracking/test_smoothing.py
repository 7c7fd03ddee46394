"""Sums over whole logs are done in a process beside the web process."""

import asyncio
import multiprocessing

import msgspec
import pytest

from backend.errors import NotFound
from backend.tracking import smoothing
from backend.tracking.heads import Head
from backend.tracking.smoothing import Smoothing
from backend.tracking.sums_process import smooth_log
from estimator.trackers.base import TrackerSettings


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
