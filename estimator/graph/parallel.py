"""Sums that do not depend on each other, at once: compiled loops let go of the interpreter while they run.

Each is worked out by one thread, and what they give is put together in the order of the items: how many
threads there are changes no bit of it.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import TypeVar

from numba import get_num_threads

T = TypeVar("T")
MANY = 10_000
"""From so many rows on they are worth sharing out: fewer are done before threads have begun."""


@cache
def _threads() -> ThreadPoolExecutor:
    """One for each core for this process but that of who asks."""
    return ThreadPoolExecutor(max(get_num_threads() - 1, 1), thread_name_prefix="at once")


def in_parallel(function: Callable[..., T], *items: Iterable[object]) -> list[T]:
    """What a function gives for each item, or each row of items, in their order.

    Each thread takes the next item that is left: it is woken once for all of them, not once for each. Who
    asks works along, and waits for none that has not begun.

    Args:
        function: changes nothing that another item's call reads.
        items: its arguments, as many of each.

    Raises:
        Exception: what the function raised first, by the order of the items; by then all have ended.
    """
    rows = list(zip(*items, strict=True))
    found, raised, left = dict[int, T](), dict[int, Exception](), iter(range(len(rows)))

    def work() -> None:
        for i in left:
            try:
                found[i] = function(*rows[i])
            except Exception as error:  # noqa: BLE001 - who asks is told
                raised[i] = error

    asked = [_threads().submit(work) for _ in range(min(get_num_threads(), len(rows)) - 1)]
    work()
    for one in asked:
        if not one.cancel():
            one.result()
    if raised:
        raise raised[min(raised)]
    return [found[i] for i in range(len(rows))]


def in_shares(work: Callable[[int, int], T], count: int, waited: bool) -> list[T]:
    """What some work on rows that do not depend on each other gives: share by share, in their order.

    Args:
        work: takes the first row of a share, and the one after its last; changes those rows only.
        count: how many rows there are.
        waited: somebody waits for it: `MANY` rows or more are shared out among the cores.
    """
    shares = get_num_threads() if waited and count >= MANY else 1
    ends = [count * share // shares for share in range(shares + 1)]
    if shares == 1:
        return [work(0, count)]
    return in_parallel(work, ends[:-1], ends[1:])
