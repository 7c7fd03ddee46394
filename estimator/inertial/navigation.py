"""From samples to displacements, piece by piece, however they are cut."""

import math
from typing import NamedTuple

import numpy as np

from estimator.graph.dense import Array
from estimator.inertial.after_gaps import keep_heading
from estimator.inertial.boot import TURNED_RAD2
from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.dropped_samples import BRIDGED_S, TURNING_S, bridge, long_turn_rad2, short_turn_rad2
from estimator.inertial.integration import integrate
from estimator.inertial.plausibility import plausible_displacement
from estimator.inertial.progress import JITTER_MOST_S, JITTER_S, Navigation
from estimator.inertial.sample_rate import add_epoch
from estimator.inertial.samples import Samples
from estimator.inertial.short_gaps import CROSSED_S, edge_of
from estimator.inertial.stuck_sensor import drop_stuck_samples
from estimator.measurements.imu import RATE_MIN_HZ

UNUSUAL = 4.0
"""An epoch that is late by more of the usual jitters is no jitter: samples are missing."""
CLOCK_GAIN, JITTER_GAIN = 0.2, 0.1
"""So much of a jitter the boot's own clock follows with each piece, that none of the two clocks runs away;
and so much a piece tells of how much they jitter."""
PACE_SIGMAS = 3.0
"""What comes early by no more sigmas of its clock's pace may follow all the same, where nothing repeats."""
REPORTED = "samples of this time were reported before"
READINGS_MOST = 8
"""Of so many readings at once it is known that a part was new."""


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
    displacements: list[InertialDisplacement]
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
    done = _navigate_piece(before or Navigation.new(piece.t, heading_rad, piece.rate_hz), piece)
    known, text = done.navigation, done.text
    others = known.begun[known.begun != piece.first_t]
    taken = text is None or bool(done.displacements) or len(others) < len(known.begun)
    if text == REPORTED and (taken or not piece.last):
        text = None  # What overlaps is nothing new; what brings nothing else is said to.
    begun = others if piece.last or not taken else np.append(others, piece.first_t)[-READINGS_MOST:]
    return done._replace(navigation=known._replace(begun=begun), text=text, taken=taken)


def _navigate_piece(known: Navigation, piece: Samples) -> Navigated:
    if piece.rate_hz < RATE_MIN_HZ:
        text = f"{piece.rate_hz:g} samples a second are fewer than {RATE_MIN_HZ:g}"
        return Navigated(known, [], 0.0, text)
    samples, span_s = piece.array, known.clock.counted / piece.rate_hz
    overlaps = bool((samples == known.newest).all(axis=1).any())
    if piece.t == piece.first_t:
        known = _update_clock(known, piece, overlaps)
    step_s, new = known.clock.pace / piece.rate_hz, len(samples)
    off_s = piece.first_t + (piece.t - piece.first_t) * known.clock.pace - known.t
    usual_s = JITTER_MOST_S if overlaps else max(JITTER_MOST_S, PACE_SIGMAS * known.clock.sigma * span_s)
    if off_s < -min(usual_s, 0.5 * max(span_s, piece.count * step_s)):
        samples = samples[round(-off_s / step_s) :]
        if not len(samples):
            return Navigated(known, [], 0.0, REPORTED)
        off_s = 0.0
    counted = known.clock.counted + (len(samples) if overlaps else new)
    known = known._replace(clock=known.clock._replace(counted=counted))
    samples, known, turned, found = _append_samples(known, piece.node, off_s, step_s, samples)
    sifted = drop_stuck_samples(known.watch, known.waiting, samples, known.missing, step_s)
    texts, end_t = [sifted.text], known.t + len(samples) * step_s
    known = known._replace(t=known.t - len(known.waiting) * step_s)
    for missing, some in sifted.parts:
        if missing:
            known, more, _ = _skip_gap(known, None, step_s * (missing - known.missing), step_s * missing)
            turned += more
        led, known, said = integrate(known, piece.node, some, step_s)
        found, texts = found + led, [said, *texts]
    known = known._replace(t=end_t, watch=sifted.watch, waiting=sifted.waiting, missing=sifted.missing)
    return Navigated(known, found, turned, next((text for text in texts if text is not None), None))


def _update_clock(known: Navigation, piece: Samples, overlaps: bool) -> Navigation:
    """Update the unit's clock by a reading's epoch; the end of the samples before it moves accordingly."""
    clock = add_epoch(known.clock, piece.t, piece.rate_hz, overlaps)
    more_s = (clock.pace - known.clock.pace) * known.clock.counted / known.clock.rate_hz
    return known._replace(t=known.t + more_s, clock=clock)


def _append_samples(
    known: Navigation, node: str, off_s: float, step_s: float, samples: Array
) -> tuple[Array, Navigation, float, list[InertialDisplacement]]:
    """Append samples that begin `off_s` (s) after the last one ended, bridging or skipping what is missing.

    A gateway's epochs jitter, and no sample is lost; or some are. What is later than its epochs usually are
    is taken for the latter.

    Returns:
        The samples with those that bridge what is missing; where they go on; the variance of the heading by
        what is missing (rad²); what has been led to before that and not been told.
    """
    before, known = known.newest, known._replace(newest=samples[-1].copy())
    if off_s <= max(1.5 * step_s, UNUSUAL * math.sqrt(known.jitter_s2)):
        jitter_s2 = known.jitter_s2 + JITTER_GAIN * (min(off_s**2, JITTER_MOST_S**2) - known.jitter_s2)
        return samples, known._replace(t=known.t + CLOCK_GAIN * off_s, jitter_s2=jitter_s2), 0.0, []
    missing = round(off_s / step_s)
    if off_s > BRIDGED_S or not (known.boot.levelled or known.boot.to_be_levelled):
        gone, edge = known.missing + len(known.waiting), known.edge[:0]
        if not gone and off_s <= CROSSED_S and known.boot.levelled:
            edge = edge_of(known.t, known.boot, before)
        known, turned_rad2, found = _skip_gap(known, node, off_s, off_s + gone * step_s)
        if len(edge) and off_s <= TURNING_S:
            turned_rad2 = short_turn_rad2(np.array([before, samples[0]]), off_s)
        return samples, known._replace(waiting=known.waiting[:0], edge=edge), turned_rad2, found
    boot = known.boot.copy()
    between, lost_m2, turned_rad2 = bridge(boot, before, samples[0], missing, off_s)
    t = known.t + off_s - missing * step_s
    known = known._replace(t=t, unsure_m2=known.unsure_m2 + lost_m2, boot=boot)
    return np.vstack([between, samples]), known, turned_rad2, []


def _skip_gap(
    known: Navigation, node: str | None, ahead_s: float, gone_s: float
) -> tuple[Navigation, float, list[InertialDisplacement]]:
    """Go on `ahead_s` (s) later after missing samples, `gone_s` (s) after the last one that was used.

    Nothing is told of the time up to the gap where there is no `node`: a sensor may have been stuck in it.

    Returns:
        Where it goes on; the variance of its heading by what is missing (rad²); the displacement up to there.
    """
    t, boot, stretched_m = known.t + ahead_s, known.boot.copy(), known.stretched_m
    found: list[InertialDisplacement] = []
    if boot.levelled:
        if node is not None and t - gone_s > known.told_t + JITTER_S:
            unsure = known.unsure_m2, stretched_m, known.clock.sigma
            found, stretched_m = plausible_displacement(boot, node, (known.told_t, t - gone_s), *unsure)
            boot.known[TURNED_RAD2] = 0.0
        keep_heading(boot)
    boot = boot.to_level_again()
    known = known._replace(t=t, told_t=t, unsure_m2=0.0, missing=0, stretched_m=stretched_m, boot=boot)
    return known._replace(unplaced=known.unplaced[:0], edge=known.edge[:0]), long_turn_rad2(gone_s), found
