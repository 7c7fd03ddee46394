"""From samples to displacements, piece by piece, however they are cut."""

import math
from typing import NamedTuple, Self

import numpy as np

from estimator.graph.dense import Array
from estimator.inertial.advancing import advance
from estimator.inertial.boot import (
    ATTITUDE,
    BIAS_RADPS,
    CHANGED,
    FLAT_M2,
    FOOTHOLD_M,
    FORCE,
    GRAVITY_MPS2,
    MOVED_M2,
    RESTED_S,
    TURNED_RAD2,
    VELOCITY,
    Boot,
)
from estimator.inertial.holding import UNHELD_S
from estimator.inertial.levelling import ALIGN_S, ANYWHERE_RAD
from estimator.inertial.loose import tell
from estimator.inertial.repeating import sift, unwatched
from estimator.inertial.resting import TOLD_AFTER_S
from estimator.inertial.samples import Samples
from estimator.inertial.strapdown import ATTITUDE_WALK, FORCE_SIGMA_MPS2, SCALE_SIGMA
from estimator.measurements.displacement import Displacement
from estimator.measurements.imu import RATE_MIN_HZ

EACH_S = 0.5
"""A displacement is told so often."""
JITTER_S, JITTER_MOST_S = 0.002, 0.05
"""By so much epochs are off that a gateway gives, before they have told; and by so much at most, where
samples follow each other all the same."""
UNUSUAL = 4.0
"""An epoch that is late by more of the usual jitters is no jitter: samples are missing."""
FOLLOWED, TOLD = 0.2, 0.1
"""So much of a jitter the boot's own clock follows with each piece, that none of the two clocks runs away;
and so much a piece tells of how much they jitter."""
BRIDGED_S = 0.1
"""So long a gap is bridged: between a swing's samples there is a straight line for a tenth of a second."""
BRIDGED_OFF, FASTER_OFF = 0.3, 0.5
"""What a bridge may be off by, as a share of what goes on in it; and so much of its forces nothing holds."""
STRIDE_SIGMA_M_PER_ROOT_M = 0.02
"""Random error of a stride, more than the filter itself believes, which takes each standstill for perfect:
published errors of ZUPT-aided units are 0.3 to 1 % of ways of some ten strides, heights as much."""
FELT_OFF_MPS2 = math.hypot(FORCE_SIGMA_MPS2, SCALE_SIGMA * GRAVITY_MPS2)
"""What its accelerometers may be off by, and no motion."""
FASTEST_MPS = 25.0
"""A runner's boot swings twice as fast as he runs."""
TURNS_RADPS, TURNED_RAD, TURNED_RADPS = 3.0, 1.0, 0.1
"""While samples are missing their bearer may turn on his heel; then he mostly goes on; in the end he may face
anything, which is 1.8 rad."""

STEEP_RAD = 0.1  # as much as a heading is unsure by that is told without a sigma
STEEP = "what its x axis faces can hardly be told when it begins: it points up or down, or the boot moves"
REPORTED = "samples of this time were reported before"
BEGUN_MOST = 8
"""Of so many readings at once it is known that a part was new."""


class Led(Displacement, tag="led", frozen=True):
    """A displacement that samples have made: it counts with them.

    Attributes:
        up_m2: variance of its height beside `sigma_m`, as floors may not be flat (m²).
        turned_rad2: variance that its heading gains, beside what the bias does to it (rad²).
        bias_rad2ps2: variance that the bias of its heading takes: it has begun without a good rest, or a
            rest has told that it was another one ((rad/s)²).
        rested_radps: a rest has, some seconds ago: it is nil now but for so much (rad/s); nil: none has.
    """

    up_m2: float = 0.0
    turned_rad2: float = 0.0
    bias_rad2ps2: float = 0.0
    rested_radps: float = 0.0


class Navigation(NamedTuple):
    """A boot's navigation between two pieces.

    Attributes:
        t: end of its newest sample, by its own clock (s).
        told_t: end of what has been told as displacements (s).
        began_rad: what its x axis was told to face when it began.
        unsure_m2: variance of its place by what has been bridged since `told_t` (m²).
        jitter_s2: variance of the epochs that its gateway gives (s²).
        newest: its newest sample, 6 (m/s², rad/s).
        watch: what has been seen of it, see `repeating.watched`.
        waiting: its newest samples which may turn out to be no readings, k × 6: they are not in `boot`.
        begun: when readings begin of which a part was new, and whose last piece is still to come, n (s).
        missing: so many before these are missing, and `boot` has not been told yet.
        boot: its strapdown navigation; its place counts from where it was at `told_t`.
    """

    t: float
    told_t: float
    began_rad: float
    unsure_m2: float
    jitter_s2: float
    newest: Array
    watch: Array
    waiting: Array
    begun: Array
    missing: int
    boot: Boot

    @classmethod
    def new(cls, t: float, heading_rad: float) -> Self:
        """That of a boot of which nothing is known at `t` but what its x axis faces."""
        began = t, t, heading_rad, 0.0, JITTER_S**2
        empty = np.zeros((0, 6)), np.zeros(0)
        return cls(*began, np.zeros(6), unwatched(), *empty, 0, Boot.new(heading_rad))


class Navigated(NamedTuple):
    """What a piece has led to.

    Attributes:
        navigation: after it.
        displacements: in order of epoch, in the frame whose x axis the boot faced at the start.
        turned_rad2: variance of its heading by samples that are missing, or may be, before it (rad²).
        text: why samples could not be used, if they could not.
        taken: whether a part of its reading was of use, up to this piece.
    """

    navigation: Navigation
    displacements: list[Led]
    turned_rad2: float
    text: str | None
    taken: bool = False


def navigate(before: Navigation | None, piece: Samples, heading_rad: float) -> Navigated:
    """Sum up a piece of samples.

    Args:
        before: where the node's earlier ones have led to; None: these are its first.
        piece: the samples.
        heading_rad: direction of the sensor's x axis at rest, seen from above, where the node is new.
    """
    done = _navigated(before or Navigation.new(piece.t, heading_rad), piece)
    known, text = done.navigation, done.text
    others = known.begun[known.begun != piece.first_t]
    taken = text is None or bool(done.displacements) or len(others) < len(known.begun)
    if text == REPORTED and (taken or not piece.last):
        text = None  # What overlaps is nothing new; what brings nothing else is said to.
    begun = others if piece.last or not taken else np.append(others, piece.first_t)[-BEGUN_MOST:]
    return done._replace(navigation=known._replace(begun=begun), text=text, taken=taken)


def _navigated(known: Navigation, piece: Samples) -> Navigated:
    if piece.rate_hz < RATE_MIN_HZ:
        text = f"{piece.rate_hz:g} samples a second are fewer than {RATE_MIN_HZ:g}"
        return Navigated(known, [], 0.0, text)
    step_s = 1.0 / piece.rate_hz
    samples, off_s = piece.array, piece.t - known.t
    if off_s < -min(JITTER_MOST_S, 0.5 * piece.count * step_s):
        samples = samples[round(-off_s / step_s) :]
        if not len(samples):
            return Navigated(known, [], 0.0, REPORTED)
        off_s = 0.0
    samples, known, turned = _joined(known, off_s, step_s, samples)
    sifted = sift(known.watch, known.waiting, samples, known.missing, step_s)
    found, texts, end_t = list[Led](), [sifted.text], known.t + len(samples) * step_s
    known = known._replace(t=known.t - len(known.waiting) * step_s)
    for missing, some in sifted.parts:
        if missing:
            known, more = _lost(known, step_s * (missing - known.missing), step_s * missing)
            turned += more
        led, known, told = _led(known, piece.node, some, step_s)
        found, texts = found + led, [told, *texts]
    known = known._replace(t=end_t, watch=sifted.watch, waiting=sifted.waiting, missing=sifted.missing)
    return Navigated(known, found, turned, next((text for text in texts if text is not None), None))


def _joined(
    known: Navigation, off_s: float, step_s: float, samples: Array
) -> tuple[Array, Navigation, float]:
    """Samples that begin `off_s` after the last one ended, put behind it.

    A gateway's epochs jitter, and no sample is lost; or some are. What is later than its epochs usually are
    is taken for the latter.

    Returns:
        The samples with those that bridge what is missing; where they go on; the variance of the heading by
        what is missing (rad²).
    """
    before, known = known.newest, known._replace(newest=samples[-1].copy())
    if off_s <= max(1.5 * step_s, UNUSUAL * math.sqrt(known.jitter_s2)):
        jitter_s2 = known.jitter_s2 + TOLD * (min(off_s**2, JITTER_MOST_S**2) - known.jitter_s2)
        return samples, known._replace(t=known.t + FOLLOWED * off_s, jitter_s2=jitter_s2), 0.0
    missing = round(off_s / step_s)
    if off_s > BRIDGED_S or not known.boot.levelled:
        gone = known.missing + len(known.waiting)
        known, turned_rad2 = _lost(known, off_s, off_s + gone * step_s)
        return samples, known._replace(waiting=known.waiting[:0]), turned_rad2
    shares = (np.arange(1, missing + 1) / (missing + 1.0))[:, None]
    bridge = before + shares * (samples[0] - before)
    velocity, rate = known.boot.held.velocity, bridge[:, 3:]
    lost_m2 = (BRIDGED_OFF * off_s) ** 2 * float(np.dot(velocity, velocity))
    turned_rad2 = (BRIDGED_OFF * off_s) ** 2 * float((rate**2).sum(axis=1).max())
    boot = known.boot.copy()
    for each in (boot.held, boot.free):
        each.covariance[range(ATTITUDE, FORCE), range(ATTITUDE, FORCE)] += turned_rad2
    ahead = bridge[:, :3] @ boot.free.attitude.T - (0.0, 0.0, GRAVITY_MPS2)
    faster_m2ps2 = (FASTER_OFF * off_s) ** 2 * float((ahead**2).sum(axis=1).max())
    boot.free.covariance[range(VELOCITY, ATTITUDE), range(VELOCITY, ATTITUDE)] += faster_m2ps2
    known = known._replace(
        t=known.t + off_s - missing * step_s, unsure_m2=known.unsure_m2 + lost_m2, boot=boot
    )
    return np.vstack([bridge, samples]), known, turned_rad2


def _lost(known: Navigation, ahead_s: float, gone_s: float) -> tuple[Navigation, float]:
    """Go on after missing samples, `ahead_s` from where it is; none have told anything for `gone_s`.

    Returns:
        Where it goes on; the variance of its heading by what is missing (rad²).
    """
    turned = min(TURNS_RADPS * gone_s, TURNED_RAD + TURNED_RADPS * gone_s, ANYWHERE_RAD)
    t = known.t + ahead_s
    known = known._replace(t=t, told_t=t, unsure_m2=0.0, missing=0, boot=known.boot.anew())
    return known, turned**2


def _led(
    known: Navigation, node: str, samples: Array, step_s: float
) -> tuple[list[Led], Navigation, str | None]:
    """What samples that go on from `known` lead to."""
    boot, told_t, unsure_m2 = known.boot.copy(), known.told_t, known.unsure_m2
    force, rate = np.ascontiguousarray(samples[:, :3]), np.ascontiguousarray(samples[:, 3:])
    found: list[Led] = []
    text, done = None, 0
    while done < len(force):
        # Up to where the next displacement is told, by the boot's own clock.
        upto = min(max(round((told_t + EACH_S - known.t) / step_s), done + 1), len(force))
        navigates, known_before = boot.levelled, boot.gyros[BIAS_RADPS] > 0.0
        done += advance(boot, force[done:upto], rate[done:upto], step_s)
        t = known.t + done * step_s
        if not navigates:
            if not boot.levelled and t > told_t + EACH_S + JITTER_MOST_S:
                text = "its samples feel no gravity: the unit is dead, or measures in other units"
            if boot.levelled and not known_before:
                # It stood meanwhile, or may have been swung anywhere.
                found.append(_displacement(boot, node, max(told_t, t - ALIGN_S), t, 0.0))
                if math.sqrt(boot.known[TURNED_RAD2]) > STEEP_RAD:
                    text = STEEP
                boot.gyros[CHANGED] = boot.known[TURNED_RAD2] = 0.0
            told_t = t if boot.levelled else told_t
        elif t >= told_t + EACH_S - 0.5 * step_s:
            tell(boot, t - told_t)
            if _sound(boot):
                found.append(_displacement(boot, node, told_t, t, unsure_m2))
            else:
                text = "the boot never stood, or its samples are wrong: it is levelled anew"
                boot = boot.anew()
            told_t, unsure_m2 = t, 0.0
            boot.loose[:3] -= boot.held.place
            boot.footing[FOOTHOLD_M] -= boot.held.place[2]
            boot.held.place[:] = boot.unheld[3:] = 0.0
            boot.footing[FLAT_M2] = 0.0
            boot.loose[MOVED_M2 : MOVED_M2 + 2] = boot.gyros[CHANGED] = boot.known[TURNED_RAD2] = 0.0
            if boot.gyros[RESTED_S] > TOLD_AFTER_S:
                boot.gyros[RESTED_S] = 0.0
    end_t = known.t + len(force) * step_s
    return found, known._replace(t=end_t, told_t=told_t, unsure_m2=unsure_m2, boot=boot), text


def _sound(boot: Boot) -> bool:
    """Whether it moves as a boot may, and knows how well it knows that."""
    speed = float(np.sqrt(np.dot(boot.held.velocity, boot.held.velocity)))
    return speed < FASTEST_MPS and all(bool(np.isfinite(array).all()) for array in (*boot.held, *boot.free))


def _displacement(boot: Boot, node: str, from_t: float, t: float, unsure_m2: float) -> Led:
    held, velocities = boot.held, range(VELOCITY, ATTITUDE)
    east, north, up = held.place.tolist()
    speed_m2 = max(float(held.covariance[velocities, velocities].max()), 0.0) * (t - from_t) ** 2
    way_m2 = STRIDE_SIGMA_M_PER_ROOT_M**2 * float(np.sqrt(np.dot(held.place, held.place)))
    moved_m2, lifted_m2 = boot.loose[MOVED_M2 : MOVED_M2 + 2].tolist()
    # What it stands on may have moved: then it went so far at least, but for what its sensors feel at rest.
    felt_m2 = (FELT_OFF_MPS2 * UNHELD_S * (t - from_t)) ** 2
    moved_m2 = max(moved_m2, float(np.dot(boot.unheld[3:], boot.unheld[3:])) - felt_m2)
    return Led(
        t=t,
        node=node,
        delta_m=(east, north, up),
        from_t=from_t,
        heading_rad=boot.heading_rad,
        sigma_m=math.sqrt(way_m2 + speed_m2 + moved_m2 + unsure_m2) + 1e-6,
        up_m2=float(boot.footing[FLAT_M2]) + max(lifted_m2 - moved_m2, 0.0),
        turned_rad2=ATTITUDE_WALK**2 * (t - from_t) + float(boot.known[TURNED_RAD2]),
        bias_rad2ps2=float(boot.gyros[CHANGED]),
        rested_radps=float(boot.gyros[BIAS_RADPS]) if boot.gyros[RESTED_S] > TOLD_AFTER_S else 0.0,
    )
