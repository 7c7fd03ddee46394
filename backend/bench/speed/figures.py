"""What is said of a series of times."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

MS = 1e3
US = 1e6


class Spent(NamedTuple):
    """What one second of readings took.

    Attributes:
        estimates_s: until there were estimates (s).
        whole_s: until there were their covariances as well (s).
    """

    estimates_s: float
    whole_s: float


class Figures(NamedTuple):
    """A series of times in figures.

    Attributes:
        median_ms: of a keyframe (ms).
        mean_ms: of a keyframe (ms).
        p99_ms: 99 of 100 keyframes took less (ms).
        first_ms: mean of the first quarter (ms).
        last_ms: mean of the last quarter (ms).
        reading_us: mean of a reading (µs).
    """

    median_ms: float
    mean_ms: float
    p99_ms: float
    first_ms: float
    last_ms: float
    reading_us: float

    @property
    def growth(self) -> float:
        """Last quarter over first."""
        return self.last_ms / self.first_ms


def figures_of(spent_s: Sequence[float], readings: int) -> Figures:
    """The figures of a series of times.

    Args:
        spent_s: what each keyframe took (s); one at least.
        readings: so many were taken in, in all.

    Raises:
        ValueError: there is no time.
    """
    if not spent_s:
        raise ValueError("there is no time")
    ms = MS * np.asarray(spent_s)
    quarter = max(1, len(ms) // 4)
    return Figures(
        median_ms=float(np.median(ms)),
        mean_ms=float(ms.mean()),
        p99_ms=float(np.quantile(ms, 0.99)),
        first_ms=float(ms[:quarter].mean()),
        last_ms=float(ms[-quarter:].mean()),
        reading_us=float(ms.sum()) / MS * US / max(readings, 1),
    )
