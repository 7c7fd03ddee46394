"""Samples at the end of a sensor's range: what goes on beyond it is lost, and with it a part of each stride.

A unit whose accelerometers end at 2 g cuts each swing, and each blow of a heel, to a flat top: the same
value, bit for bit, in samples that follow each other, and none beyond it. What that hides is guessed from how
steeply it is entered, and doubted by as much: the next standstill then tells how much was lost, and when. A
blow of two hundredths of a second may hide more than that.
"""

from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import ATTITUDE, VELOCITY, Strapdown
from estimator.inertial.stuck_sensor import CHANNELS

LEAST_MPS2, LEAST_RADPS = 15.0, 4.0
"""No range ends below 2 g, or 250 degrees a second, but for what scale and bias take away."""
ALIKE = 1e-3
"""The two ends of a range are as far from nil, but for so much."""
LAST, STEP, BEFORE, SLOPE, MOST, ENDS, RUN, RUNS = 0, 6, 12, 18, 24, 30, 36, 42
"""Where each begins in what is remembered."""
OFTEN = 20.0
"""What has been cut so many times is cut with each stride."""


@njit(cache=True, error_model="numpy")
def hidden_peak(clipped: Array, force: Array, rate: Array, step_s: float, lost: Array) -> bool:
    """Take in a sample, and tell what a flat top hides.

    A peak is taken for a parabola, entered as steeply as the steeper of two steps before it. Its edges lie
    up to a sample and a half beyond what is seen flat: n samples hide step · slope · n (1 + n / 6).

    Args:
        clipped: of each channel its last value, its last two steps, the slope at which it reached the end of
            its range, the most that it has told, whether that is the end, for how many samples it has been
            there, and how often: 6 each, changed in place.
        force: specific force as the unit tells it, 3 (m/s²).
        rate: angular rate as it tells it, 3 (rad/s).
        step_s: time from one sample to the next (s).
        lost: takes by how much the variances of velocity (m²/s²) and attitude (rad²) grow along each axis of
            the sensor, 6.

    Returns:
        Whether anything is hidden.
    """
    found = False
    for c in range(6):
        value = force[c] if c < 3 else rate[c - 3]
        size, step, lost[c] = abs(value), abs(value - clipped[LAST + c]), 0.0
        clipped[LAST + c] = value
        if step > 0.0:
            clipped[BEFORE + c], clipped[STEP + c] = clipped[STEP + c], step
        begun = 0.0
        if size > (1.0 + ALIKE) * clipped[MOST + c]:
            clipped[MOST + c], clipped[ENDS + c] = size, 0.0
        elif step == 0.0 and clipped[ENDS + c] == 0.0 and size > (1.0 - ALIKE) * clipped[MOST + c]:
            # The sample before was there already.
            clipped[ENDS + c], begun = 1.0, 1.0
        least = LEAST_MPS2 if c < 3 else LEAST_RADPS
        if size < least or clipped[ENDS + c] == 0.0 or size < (1.0 - ALIKE) * clipped[MOST + c]:
            clipped[RUN + c] = 0.0
            continue
        run = clipped[RUN + c]
        if run == 0.0:
            clipped[SLOPE + c] = max(clipped[STEP + c], clipped[BEFORE + c])
            clipped[RUNS + c] += 1.0
        clipped[RUN + c] = run + begun + 1.0
        hides = _shape(clipped[RUN + c]) ** 2 - _shape(run) ** 2
        lost[c] = (step_s * clipped[SLOPE + c]) ** 2 * hides
        found = True
    return found


@njit(cache=True, error_model="numpy")
def _shape(run: float) -> float:
    return run * (1.0 + run / 6.0)


@njit(cache=True, error_model="numpy")
def doubt(boot: Strapdown, lost: Array) -> None:
    """Doubt velocity and attitude by what is hidden along each axis of the sensor.

    Args:
        boot: its covariance is changed in place.
        lost: see `hidden_peak`.
    """
    for channel in range(6):
        if lost[channel] == 0.0:
            continue
        at, axis = VELOCITY if channel < 3 else ATTITUDE, boot.attitude[:, channel % 3]
        for r in range(3):
            for c in range(3):
                boot.covariance[at + r, at + c] += lost[channel] * axis[r] * axis[c]


def remark(clipped: Array) -> str | None:
    """What is to be said of a unit whose range is too narrow for its bearer's strides."""
    named = [
        f"{name} ends at {clipped[MOST + c]:.3g} {'m/s²' if c < 3 else 'rad/s'}"
        for c, name in enumerate(CHANNELS)
        if clipped[ENDS + c] and clipped[RUNS + c] > OFTEN
    ]
    if not named:
        return None
    return (
        f"its unit's {', '.join(named)}, and each stride goes beyond: what is lost there makes his way less"
        " sure; set a wider range"
    )
