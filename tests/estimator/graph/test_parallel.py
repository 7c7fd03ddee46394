"""Sums at once: what comes of them is what would come of them one after the other."""

import threading
from collections.abc import Callable, Iterable
from itertools import chain as chained

import numpy as np
import pytest

from estimator.graph import parallel
from estimator.graph.parallel import in_parallel, in_shares
from estimator.smoothing.chain import chain
from tests.estimator.smoothing.windows import fused, problem_of
from tests.estimator.walks import two_responders

SOON_S = 10.0


def test_what_it_gives_is_in_the_order_of_the_items_whichever_ends_first() -> None:
    second_ended = threading.Event()

    def work(name: str, number: int) -> str:
        if name == "first" and not second_ended.wait(SOON_S):
            return "the second one has not begun"
        second_ended.set()
        return f"{name} {number}"

    assert in_parallel(work, ["second", "first"], [1, 2]) == ["second 1", "first 2"]


def test_what_one_of_them_raises_is_raised_when_all_have_ended() -> None:
    ended: list[int] = []

    def work(number: int) -> None:
        if number < 3:
            raise ValueError(f"the chain of walk {number} is not positive definite")
        ended.append(number)

    with pytest.raises(ValueError, match="walk 1"):
        in_parallel(work, [1, 2, 3, 4, 5, 6])
    assert sorted(ended) == [3, 4, 5, 6]


def test_shares_of_rows_are_all_of_them_once_and_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel, "get_num_threads", lambda: 3)
    monkeypatch.setattr(parallel, "MANY", 4)
    for count in range(12):
        shares = in_shares(lambda first, last: list(range(first, last)), count, waited=True)
        assert list(chained.from_iterable(shares)) == list(range(count))
        assert len(shares) == (1 if count < 4 else 3)
        assert len(in_shares(lambda *share: share, count, waited=False)) == 1


def watched(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What is worked on at once from now on, by name: all that may be, however small."""
    used: list[str] = []

    def at_once(work: Callable[..., object], *items: Iterable[object]) -> list[object]:
        used.append(getattr(work, "__qualname__", "?"))
        return in_parallel(work, *items)

    monkeypatch.setattr(chain, "LARGE", 0)
    monkeypatch.setattr(chain, "in_parallel", at_once)
    return used


def test_a_window_of_a_live_incident_stays_on_one_core(monkeypatch: pytest.MonkeyPatch) -> None:
    state = fused(two_responders())
    state.ledger.complete = False
    problem = problem_of(state)
    used = watched(monkeypatch)
    problem.solve(problem.layout.start())
    assert not used


def test_a_window_solved_at_once_is_the_same_to_the_last_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = problem_of(fused(two_responders()))
    x = problem.layout.start()
    one_by_one = problem.solve(x)
    used = watched(monkeypatch)
    together = problem.solve(x)
    assert len(together.chain.strands) > 2
    assert used
    assert np.array_equal(together.x, one_by_one.x)
    assert together.cost == one_by_one.cost
    one_by_one.chain.reduce()
    together.chain.reduce()
    for found, expected in zip(together.chain.covariances(), one_by_one.chain.covariances(), strict=True):
        assert np.array_equal(found, expected)
