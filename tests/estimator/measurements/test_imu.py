"""Raw samples of a boot, and what they tell of."""

import pytest

from estimator.measurements.imu import Imu, told_until

SAMPLES = Imu(
    t=10.0,
    node="ff1",
    rate_hz=100.0,
    accel_mps2=[(0.0, 0.0, 9.81 + k * 1e-3) for k in range(300)],
    gyro_radps=[(0.0, 0.0, k * 1e-3) for k in range(300)],
    mag_ut=[(20.0, 0.0, float(k)) for k in range(300)],
)


@pytest.mark.parametrize(("t", "count"), [(13.0, 300), (11.5, 150), (10.014, 1), (10.0, 0), (9.0, 0)])
def test_of_a_moment_in_the_middle_its_first_samples_tell(t: float, count: int) -> None:
    part = told_until(SAMPLES, t)
    assert (0 if part is None else len(part.accel_mps2)) == count
    if part is not None:
        assert part.until_t <= t + 1e-9
        assert part.mag_ut is not None
        assert (part.t, part.gyro_radps[-1][2], part.mag_ut[-1][2]) == (
            10.0,
            SAMPLES.gyro_radps[count - 1][2],
            count - 1.0,
        )


def test_samples_too_few_to_be_summed_up_tell_at_their_epoch() -> None:
    slow = Imu(
        t=10.0, node="ff1", rate_hz=10.0, accel_mps2=[(0.0, 0.0, 9.8)] * 30, gyro_radps=[(0.0,) * 3] * 30
    )
    assert told_until(slow, 10.0) is slow
    assert told_until(slow, 9.9) is None
