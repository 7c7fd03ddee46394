"""Processor time, not the clock's: what else the machine does is no part of a comparison.

Nothing that is timed here uses a second thread: numerics are held to one, and GTSAM's wheel has none.
"""

import time


class Stopwatch:
    """Adds up the processor time of its blocks.

    Attributes:
        spent_s: of all of them (s).
    """

    def __init__(self) -> None:
        self.spent_s = 0.0
        self._start_s = 0.0

    def __enter__(self) -> None:
        self._start_s = time.process_time()

    def __exit__(self, *_: object) -> None:
        self.spent_s += time.process_time() - self._start_s
