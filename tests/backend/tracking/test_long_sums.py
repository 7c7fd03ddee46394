"""Sums that are kept by what was asked."""

import asyncio

import pytest

from backend.errors import TooSlow
from backend.tracking import long_sums
from backend.tracking.long_sums import Kept


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
        kept, slow = Kept[int](2, asyncio.Lock()), Counted(done=False)
        asked = [asyncio.create_task(kept.get("a", 1, slow, 5.0, "This")) for _ in range(3)]
        await asyncio.sleep(0)
        slow.end.set()
        assert await asyncio.gather(*asked) == [1, 1, 1]
        assert await kept.get("a", 1, slow, 5.0, "This") == 1

    asyncio.run(ask())


def test_what_failed_is_begun_again() -> None:
    async def ask() -> None:
        kept, failing = Kept[int](2, asyncio.Lock()), Counted(fails=True)
        for _ in range(2):
            with pytest.raises(ValueError, match="no"):
                await kept.get("a", 1, failing, 5.0, "This")
        assert failing.begun == 2

    asyncio.run(ask())


def test_what_takes_long_goes_on_and_is_found_done() -> None:
    async def ask() -> None:
        kept, slow = Kept[int](2, asyncio.Lock()), Counted(done=False)
        with pytest.raises(TooSlow, match=r"This takes longer than 0\.01 s; it goes on"):
            await kept.get("a", 1, slow, 0.01, "This")
        slow.end.set()
        assert await kept.get("a", 1, slow, 5.0, "This") == 1

    asyncio.run(ask())


def test_who_waits_for_what_was_given_up_is_told_so() -> None:
    async def ask() -> None:
        kept, slow = Kept[int](1, asyncio.Lock()), Counted(done=False)
        waiting = asyncio.create_task(kept.get("a", 1, slow, 5.0, "This"))
        await asyncio.sleep(0)
        assert await kept.get("b", 1, Counted(), 5.0, "That") == 1
        with pytest.raises(TooSlow, match="in the way"):
            await waiting

    asyncio.run(ask())


def test_a_request_that_is_given_up_ends_without_ending_the_sum() -> None:
    async def ask() -> None:
        kept, slow = Kept[int](1, asyncio.Lock()), Counted(done=False)
        waiting = asyncio.create_task(kept.get("a", 1, slow, 5.0, "This"))
        await asyncio.sleep(0)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        slow.end.set()
        assert await kept.get("a", 1, slow, 5.0, "This") == 1
        assert slow.begun == 1

    asyncio.run(ask())


def test_the_sums_that_were_asked_for_longest_ago_are_given_up_first() -> None:
    async def ask() -> None:
        kept, sums = Kept[int](2, asyncio.Lock()), {name: Counted() for name in "abc"}
        for name in "abaca":
            await kept.get(name, 1, sums[name], 5.0, "This")
        assert {name: counted.begun for name, counted in sums.items()} == {"a": 1, "b": 1, "c": 1}
        await kept.get("b", 1, sums["b"], 5.0, "This")
        assert sums["b"].begun == 2

    asyncio.run(ask())


def test_of_a_log_that_grows_a_quick_sum_is_told_with_all_of_it() -> None:
    async def ask() -> None:
        kept, quick = Kept[int](2, asyncio.Lock()), Counted(done=False)
        first = asyncio.create_task(kept.get("a", 1, quick, 5.0, "This"))
        await asyncio.sleep(0)
        later = asyncio.create_task(kept.get("a", 2, quick, 5.0, "This"))
        await asyncio.sleep(0)
        quick.end.set()
        assert [await first, await later] == [1, 2]
        assert await kept.get("a", 2, quick, 5.0, "This") == 2
        assert await kept.get("a", 3, quick, 5.0, "This") == 3

    asyncio.run(ask())


def test_of_a_log_that_grows_a_sum_that_takes_longer_than_anybody_waits_is_told_when_it_is_done() -> None:
    async def ask() -> None:
        kept, slow = Kept[int](2, asyncio.Lock()), Counted(done=False)
        for seq in (1, 2):
            with pytest.raises(TooSlow) as refused:
                await kept.get("a", seq, slow, 0.1, "This")
            assert refused.value.retry_after_s
        slow.end.set()
        await asyncio.sleep(0)
        assert await kept.get("a", 3, slow, 0.1, "This") == 1
        # For as long again as it took; then it is begun anew, with what has come.
        await asyncio.sleep(0.3)
        assert await kept.get("a", 4, slow, 0.1, "This") == 2

    asyncio.run(ask())


def test_a_sum_that_nobody_waits_for_when_its_turn_comes_is_not_begun() -> None:
    async def ask() -> None:
        turn = asyncio.Lock()
        kept, others = Kept[int](4, turn), Kept[int](4, turn)
        first, left, wanted = Counted(done=False), Counted(), Counted()
        under_way = asyncio.create_task(kept.get("first", 1, first, 5.0, "This"))
        leaving = asyncio.create_task(kept.get("left", 1, left, 5.0, "This"))
        staying = asyncio.create_task(others.get("wanted", 1, wanted, 5.0, "That"))
        await asyncio.sleep(0.01)
        leaving.cancel()
        await asyncio.sleep(0.01)
        first.end.set()
        assert [await under_way, await staying] == [1, 1]
        assert (left.begun, wanted.begun) == (0, 1)
        assert await kept.get("left", 1, left, 5.0, "This") == 1

    asyncio.run(ask())


def test_who_was_told_to_ask_again_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    async def ask(returns_within_s: float) -> int:
        monkeypatch.setattr(long_sums, "RETURNS_WITHIN_S", returns_within_s)
        kept, first, second = Kept[int](4, asyncio.Lock()), Counted(done=False), Counted()
        under_way = asyncio.create_task(kept.get("first", 1, first, 5.0, "This"))
        await asyncio.sleep(0.01)
        with pytest.raises(TooSlow):
            await kept.get("second", 1, second, 0.01, "That")
        await asyncio.sleep(0.02)
        first.end.set()
        await under_way
        await asyncio.sleep(0.01)
        return second.begun

    assert asyncio.run(ask(60.0)) == 1
    assert asyncio.run(ask(0.0)) == 0
