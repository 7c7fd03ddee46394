"""Raw samples as they are folded: in pieces of half a second, each known when its last sample ends."""

from collections.abc import Iterable, Iterator

import numpy as np

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.base import Identifier, Reading
from estimator.measurements.displacement import Awaited
from estimator.measurements.imu import RATE_MIN_HZ, Imu, end_of
from estimator.measurements.node import LateNode

PIECE_S = 0.5


class Samples(Reading, tag="samples", frozen=True):
    """A piece of an `imu` reading.

    Attributes:
        t: when its first sample begins, Unix seconds; the reading may begin at the last epoch that there is.
        node: the unit.
        rate_hz: samples a second.
        count: how many these are.
        values: specific force and angular rate of each, count × 6 in C order (m/s², rad/s).
        last: it is the last piece of its reading, which counts with it.
        first_t: when its reading begins, Unix seconds.
    """

    t: float
    node: Identifier
    rate_hz: float
    count: int
    values: bytes
    last: bool
    first_t: float

    @property
    def until_t(self) -> float:
        """When its last sample ends, Unix seconds; `t`, where there are too few of them to be summed up."""
        return end_of(self.t, self.count, self.rate_hz)

    @property
    def array(self) -> Array:
        """The samples, count × 6 (m/s², rad/s)."""
        return np.frombuffer(self.values, dtype=np.float64).reshape(self.count, 6)


AnyFolded = AnyReading | Samples | LateNode | Awaited


def in_pieces(readings: Iterable[AnyReading]) -> Iterator[AnyFolded]:
    """The readings as they are folded: what would tell only after seconds is cut.

    A reading of seconds of samples would come after all that was heard meanwhile, which waits for it in vain.
    """
    for reading in readings:
        if type(reading) is Imu:
            yield from pieces(reading)
        else:
            yield reading


def pieces(reading: Imu) -> Iterator[Samples]:
    """A reading's samples in pieces of half a second."""
    values = np.hstack([np.array(reading.accel_mps2), np.array(reading.gyro_radps)])
    count = len(values)
    each = round(PIECE_S * reading.rate_hz) if reading.rate_hz >= RATE_MIN_HZ else count
    for first in range(0, count, each):
        some = values[first : first + each]
        yield Samples(
            t=reading.t + first / reading.rate_hz,
            node=reading.node,
            rate_hz=reading.rate_hz,
            count=len(some),
            values=some.tobytes(),
            last=first + each >= count,
            first_t=reading.t,
        )
