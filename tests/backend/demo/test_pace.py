"""Gateways of a scenario that is played fast keep together; those of a live one go by the real time."""

import asyncio
import math

import pytest

from backend.demo.pace import AHEAD_S, Pace

DUE_S = [0.5 * count for count in range(40)]


async def posts(pace: Pace, gateway: str, answered_after_s: float, posted: list[float]) -> None:
    """A gateway posts a batch each half second of the scenario, and waits for each answer."""
    for due_s in DUE_S:
        await pace.wait(gateway, due_s)
        posted.append(due_s)
        await asyncio.sleep(answered_after_s)
    await pace.done(gateway)


@pytest.mark.parametrize("speed", [100.0, math.inf])
def test_however_fast_it_is_played_nobody_leaves_a_gateway_behind_that_is_slowly_answered(
    speed: float,
) -> None:
    async def play() -> list[float]:
        pace, posted = Pace(speed, ["quick", "slow"]), list[float]()
        await asyncio.gather(posts(pace, "quick", 0.0, posted), posts(pace, "slow", 0.01, posted))
        return posted

    posted = asyncio.run(play())
    assert sorted(posted) == sorted(DUE_S + DUE_S)
    assert all(max(posted[: at + 1]) - due_s <= AHEAD_S + 0.5 for at, due_s in enumerate(posted))


def test_who_has_posted_everything_holds_nobody_up() -> None:
    async def play() -> None:
        pace = Pace(math.inf, ["early", "late"])
        await pace.done("early")
        await asyncio.wait_for(pace.wait("late", 1000.0), 1.0)

    asyncio.run(play())


def test_live_no_gateway_waits_for_another() -> None:
    async def play() -> None:
        pace = Pace(1.0, ["cut off", "on time"])
        pace.began -= 10.0
        await asyncio.wait_for(pace.wait("on time", 10.0), 1.0)

    asyncio.run(play())
