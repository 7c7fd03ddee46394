"""Values that repeat bit for bit: a sensor that is stuck or dead gives no readings.

What is felt at rest is noisy, and of three axes each is: a channel that has shown its noise and then
repeats is stuck. One that has shown none may be coarse, and its boot may rest; it is stuck where the boot
moves all the same and its sensor's other axes are noisy, or repeat as well. All six repeat in a rest of a
coarse unit; where what they tell is no rest nothing does that.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import GRAVITY_MPS2
from estimator.inertial.levelling import BIASED_RADPS, GRAVITY_OFF_MPS2

STUCK_S = 0.5
"""Of a noisy sensor a hundred samples are never the same, nor are those of a boot that moves."""
NEVER_S = 10.0
"""A unit that has never told anything else in so long is dead: whoever wears one moves, and breathes."""
NOISY_S, MOSTLY = 0.5, 1.25
"""What has been noisy at rest for so long, and so much longer than it repeated, is a noisy sensor: a coarse
one may go back and forth between two values half of the time."""
SOME = 4.0
"""So many samples of a noisy sensor may well repeat: nothing waits for those that follow."""
ARITHMETIC = 1e-6
"""A smaller change is no noise of a sensor (m/s², rad/s): those have some 1e-2 and 1e-3."""
MOVES_RADPS, MOVES_MPS2, MOVES_S = 1.0, 5.0, 0.2
"""A boot that turns so fast, or feels so much beside gravity, for so long is moved about each axis by more
than a sensor misses whose other axes are noisy at rest; and about one by more than the coarsest misses."""
LAST, CHANGE, REPEATED, NOISY, SAME, MOVED, ALIVE = 0, 6, 12, 18, 24, 30, 36
"""Where each begins in what is watched."""
CHANNELS = ("accelerometer x", "accelerometer y", "accelerometer z", "gyro x", "gyro y", "gyro z")
ALL = 2 ** len(CHANNELS) - 1


class LiveSamples(NamedTuple):
    """Samples, but for those that are no readings.

    Attributes:
        parts: how many of them are missing before each part (0: none), and the part's samples, m × 6.
        missing: how many are missing after the last part.
        waiting: the newest ones, k × 6: whether they are readings is not known yet.
        watch: what has been seen up to here.
        text: why some are no readings, if any.
    """

    parts: list[tuple[int, Array]]
    missing: int
    waiting: Array
    watch: Array
    text: str | None


def initial_watch() -> Array:
    """What has been seen of a unit before its first sample, 37: see `watch_channels`."""
    watch = np.zeros(ALIVE + 1)
    watch[LAST : LAST + 6] = np.nan
    return watch


def drop_stuck_samples(
    watch: Array, waiting: Array, samples: Array, missing: int, step_s: float
) -> LiveSamples:
    """Samples without those that repeat though they should not.

    Args:
        watch: what has been seen before, see `watch_channels`.
        waiting: samples that were left waiting, k × 6 (m/s², rad/s).
        samples: those that follow, m × 6.
        missing: how many are missing before these.
        step_s: time from one sample to the next (s).
    """
    watch, values = watch.copy(), np.vstack([waiting, samples])
    stuck = np.zeros(len(values))
    waits = watch_channels(watch, values, len(waiting), step_s, stuck)
    upto = len(values) - waits
    edges = np.flatnonzero(np.diff(stuck[:upto] != 0)) + 1
    parts: list[tuple[int, Array]] = []
    for first, last in zip([0, *edges], [*edges, upto], strict=True):
        if first == last:
            continue
        if stuck[first]:
            missing += int(last - first)
        else:
            parts.append((missing, values[first:last]))
            missing = 0
    return LiveSamples(
        parts, missing, values[upto:].copy(), watch, _text(int(np.bitwise_or.reduce(stuck.astype(np.int64))))
    )


def _text(stuck: int) -> str | None:
    if not stuck:
        return None
    named = [name for channel, name in enumerate(CHANNELS) if stuck >> channel & 1]
    which = "all its channels" if stuck == ALL else " and ".join(named)
    return (
        f"stuck, {which}: the values repeat bit for bit, which those of no working sensor do; the samples are"
        " taken for missing, and it is levelled anew when they change: switch the unit off and on, or replace"
        " it"
    )


@njit(cache=True, error_model="numpy")
def watch_channels(watch: Array, values: Array, before: int, step_s: float, stuck: Array) -> int:
    """Watch samples for channels that repeat.

    Args:
        watch: of each channel its last value, its last change, how many samples have repeated it; for how
            long it has been noisy at rest, and the same at rest (s); and for how long the boot has moved
            while it repeated (s): 6 each. Whether any has ever changed: 37, changed in place.
        values: samples, m × 6 (m/s², rad/s).
        before: so many of them have been watched before.
        step_s: time from one to the next (s).
        stuck: takes what is stuck in each that is no reading: a bit for each channel; nil elsewhere, m.

    Returns:
        Of how many of the last ones it is not known yet.
    """
    waits = before
    for i in range(before, len(values)):
        rests, turns, moves = _told(values[i])
        for c in range(6):
            # Accelerometers that tell nil all the time say nothing of a motion.
            _add_value(watch, c, values[i, c], rests, turns if c < 3 else moves, step_s)
        found, doubted = _judged(watch, rests, step_s)
        if found:
            for k in range(i - waits, i + 1):
                stuck[k] = float(found)
            waits = 0
        else:
            waits = min(doubted, waits + 1)
    return waits


@njit(cache=True, error_model="numpy")
def _told(value: Array) -> tuple[bool, bool, bool]:
    """Whether a sample is one of a boot that rests; and whether its gyros, or anything, say that it moves."""
    pull = turning = 0.0
    for c in range(3):
        pull += value[c] ** 2
        turning += value[3 + c] ** 2
    off, turning = abs(np.sqrt(pull) - GRAVITY_MPS2), np.sqrt(turning)
    turns = turning > MOVES_RADPS
    return off < GRAVITY_OFF_MPS2 and turning < BIASED_RADPS, turns, turns or off > MOVES_MPS2


@njit(cache=True, error_model="numpy")
def _add_value(watch: Array, channel: int, value: float, rests: bool, moves: bool, step_s: float) -> None:
    """Update what is known of a channel by its next value."""
    change = value - watch[LAST + channel]
    repeated = watch[REPEATED + channel]
    watch[LAST + channel] = value
    if change == 0.0:
        watch[REPEATED + channel] += 1.0
        watch[MOVED + channel] += step_s if moves else 0.0
        return
    if rests and not (_noisy(watch, channel) and repeated * step_s > STUCK_S):
        watch[SAME + channel] += repeated * step_s
    # Noise goes back and forth; a motion goes on.
    if rests and change * watch[CHANGE + channel] < 0.0 and abs(change) > ARITHMETIC:
        watch[NOISY + channel] += step_s
    watch[REPEATED + channel] = watch[MOVED + channel] = 0.0
    if np.isfinite(change):
        watch[CHANGE + channel] = change
        watch[ALIVE] = 1.0


@njit(cache=True, error_model="numpy")
def _noisy(watch: Array, channel: int) -> bool:
    """Whether a channel has shown that it is noisy at rest."""
    return bool(watch[NOISY + channel] > max(MOSTLY * watch[SAME + channel], NOISY_S))


@njit(cache=True, error_model="numpy")
def _judged(watch: Array, rests: bool, step_s: float) -> tuple[int, int]:
    """What is stuck, a bit for each channel; and how many samples may turn out to be no readings soon."""
    together = watch[REPEATED : REPEATED + 6].min()
    longest_s = STUCK_S
    if rests:
        longest_s = NEVER_S if watch[ALIVE] == 0.0 else np.inf
    if together * step_s > longest_s:
        return ALL, 0
    found, doubted = 0, 0.0 if rests else together
    for c in range(6):
        noisy, first = _noisy(watch, c), 3 * (c // 3)
        works = _noisy(watch, first) or _noisy(watch, first + 1) or _noisy(watch, first + 2)
        moved_s = watch[MOVED + c] if works else watch[MOVED + first : MOVED + first + 3].min()
        if watch[REPEATED + c] * step_s > STUCK_S and (noisy or moved_s > MOVES_S):
            found |= 1 << c
        elif noisy and watch[REPEATED + c] > SOME:
            doubted = max(doubted, watch[REPEATED + c])
    return found, int(doubted)
