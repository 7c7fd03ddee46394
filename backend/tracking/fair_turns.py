"""Turns: many incidents share few threads, and none may hold the others back."""

import time
from collections.abc import Iterator

SLICE_S = 0.02
"""Folding goes on for so long, to the end of a log entry, before other incidents have their turn."""

LONGEST_SLICE_S = 0.1
"""Within an entry of thousands of readings, others have their turn after so long."""


def for_a_while(work: Iterator[bool]) -> bool:
    """Work until time is over and an entry is whole; False when all is done."""
    began = time.perf_counter()
    for whole in work:
        spent_s = time.perf_counter() - began
        if (whole and spent_s >= SLICE_S) or spent_s >= LONGEST_SLICE_S:
            return True
    return False
