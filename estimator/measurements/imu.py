"""`imu`: raw samples of a foot-mounted inertial unit."""

from typing import Annotated

from msgspec import Meta
from msgspec.structs import replace

from estimator.measurements.base import Identifier, Reading

SampleRateHz = Annotated[float, Meta(gt=0.0, le=10_000.0)]
Accel = Annotated[float, Meta(ge=-10_000.0, le=10_000.0)]
Gyro = Annotated[float, Meta(ge=-1_000.0, le=1_000.0)]
Mag = Annotated[float, Meta(ge=-100_000.0, le=100_000.0)]
MAX_SAMPLES = 10_000
RATE_MIN_HZ = 25.0
"""A stride lasts a second: with fewer samples its swing cannot be summed up."""


class Imu(Reading, tag="imu", frozen=True):
    """Raw IMU samples in right-handed sensor axes fixed to the boot, the first one at `t`.

    Indoors the Earth's field is bent by steel: `mag_ut` is logged and not fused.

    Attributes:
        node: the unit.
        rate_hz: samples a second.
        accel_mps2: specific force, n × 3 (m/s²).
        gyro_radps: angular rate, n × 3 (rad/s).
        mag_ut: magnetic flux density, n × 3 (µT).
    """

    node: Identifier
    rate_hz: SampleRateHz
    accel_mps2: Annotated[list[tuple[Accel, Accel, Accel]], Meta(min_length=1, max_length=MAX_SAMPLES)]
    gyro_radps: Annotated[list[tuple[Gyro, Gyro, Gyro]], Meta(min_length=1, max_length=MAX_SAMPLES)]
    mag_ut: Annotated[list[tuple[Mag, Mag, Mag]], Meta(min_length=1, max_length=MAX_SAMPLES)] | None = None

    @property
    def until_t(self) -> float:
        """When its last sample ends, Unix seconds; `t`, where there are too few of them to be summed up."""
        return end_of(self.t, len(self.accel_mps2), self.rate_hz)

    def __post_init__(self) -> None:
        """Refuse sample arrays of different lengths.

        Raises:
            ValueError: `accel_mps2`, `gyro_radps` and `mag_ut` differ in length.
        """
        n = len(self.accel_mps2)
        if len(self.gyro_radps) != n or (self.mag_ut is not None and len(self.mag_ut) != n):
            raise ValueError("`accel_mps2`, `gyro_radps` and `mag_ut` must have as many samples each")


def told_until(reading: Imu, t: float) -> Imu | None:
    """The part of a reading that tells of no later epoch than `t` (s): its first samples; None: nothing."""
    if reading.until_t <= t:
        return reading
    count = int((t - reading.t) * reading.rate_hz) if reading.rate_hz >= RATE_MIN_HZ else 0
    if count < 1:
        return None
    mag_ut = None if reading.mag_ut is None else reading.mag_ut[:count]
    accel, gyro = reading.accel_mps2[:count], reading.gyro_radps[:count]
    return replace(reading, accel_mps2=accel, gyro_radps=gyro, mag_ut=mag_ut)


def end_of(t: float, count: int, rate_hz: float) -> float:
    """When samples end that begin at `t`; `t`, where there are too few of them to be summed up (s)."""
    return t + count / rate_hz if rate_hz >= RATE_MIN_HZ else t
