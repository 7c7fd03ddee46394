"""From samples that follow each other without a gap to displacements: levelled, summed up, and cut."""

import math

import numpy as np

from estimator.graph.dense import Array
from estimator.inertial.after_gaps import SOUGHT_S, find_standstill, level_backwards
from estimator.inertial.boot import (
    BIAS_RADPS,
    CHANGED,
    FARTHEST_RAD,
    FLAT_M2,
    FOOTHOLD_M,
    MOVED_M2,
    RESTED_S,
    TURNED_RAD2,
    Boot,
)
from estimator.inertial.displacement import InertialDisplacement, displacement_of
from estimator.inertial.footholds import AWAY_M, LAST_S, NOT_YET, NOW_S, count_from, due_s, place_at
from estimator.inertial.levelling import ALIGN_S
from estimator.inertial.plausibility import plausible_displacement
from estimator.inertial.progress import JITTER_MOST_S, Navigation
from estimator.inertial.short_gaps import cross, edge_of
from estimator.inertial.zaru import TOLD_AFTER_S
from estimator.inertial.zupt_aided import advance

STEEP_RAD = 0.1  # as much as a heading is unsure by that is told without a sigma
STEEP = "what its x axis faces can hardly be told when it begins: it points up or down, or the boot moves"


def integrate(
    known: Navigation, node: str, samples: Array, step_s: float
) -> tuple[list[InertialDisplacement], Navigation, str | None]:
    """Navigate samples that follow without a gap: their displacements, the navigation then, and a remark."""
    found: list[InertialDisplacement] = []
    if known.boot.to_be_levelled:
        sought = _recover_boot(known, node, samples, step_s)
        if sought is None:
            t = known.t + len(samples) * step_s
            return [], known._replace(t=t, unplaced=np.vstack([known.unplaced, samples])), None
        found, known, samples = sought
    boot, told_t, unsure_m2 = known.boot.copy(), known.told_t, known.unsure_m2
    stretched_m, pace_sigma = known.stretched_m, known.clock.sigma
    force, rate = np.ascontiguousarray(samples[:, :3]), np.ascontiguousarray(samples[:, 3:])
    text, done = None, 0
    while done < len(force):
        navigates, known_before = boot.levelled, boot.gyros[BIAS_RADPS] > 0.0
        farthest_rad = float(boot.known[FARTHEST_RAD])
        # Up to where it is levelled, or its way is to be cut.
        done += advance(boot, force[done:], rate[done:], step_s)
        boot.known[TURNED_RAD2] += pace_sigma**2 * (float(boot.known[FARTHEST_RAD]) ** 2 - farthest_rad**2)
        t = known.t + done * step_s
        if not navigates:
            if not boot.levelled and t > told_t + ALIGN_S + JITTER_MOST_S:
                text = "its samples feel no gravity: the unit is dead, or measures in other units"
            if boot.levelled and not known_before:
                # It stood meanwhile, or may have been swung anywhere.
                found.append(displacement_of(boot, node, min(max(told_t, t - ALIGN_S), t), t, 0.0))
                if math.sqrt(boot.known[TURNED_RAD2]) > STEEP_RAD:
                    text = STEEP
                boot.gyros[CHANGED] = boot.known[TURNED_RAD2] = 0.0
            told_t = t if boot.levelled else told_t
        elif (cut_s := due_s(boot.footholds)) != NOT_YET:
            cut_t = t - float(boot.footholds[NOW_S]) + cut_s
            unsure = unsure_m2, stretched_m, pace_sigma
            some, stretched_m = _cut(boot, node, (told_t, cut_t), cut_s, unsure)
            found += some
            if not some:
                text = "the boot never stood, or its samples are wrong: it is levelled anew"
                boot = boot.to_level_again()
                cut_t = t
            told_t, unsure_m2 = cut_t, 0.0
    end_t = known.t + len(force) * step_s
    known = known._replace(t=end_t, told_t=told_t, unsure_m2=unsure_m2, stretched_m=stretched_m, boot=boot)
    return found, known, text


def _recover_boot(
    known: Navigation, node: str, samples: Array, step_s: float
) -> tuple[list[InertialDisplacement], Navigation, Array] | None:
    """Level a boot after a gap: backwards from a standstill, or as at first after `SOUGHT_S` without one.

    Returns:
        The displacement over the gap, if that can be told; where it goes on; all samples after the gap. None:
            nothing tells yet where it is.
    """
    t, samples = known.t - len(known.unplaced) * step_s, np.vstack([known.unplaced, samples])
    boot, upto = known.boot.copy(), find_standstill(known.boot, samples, step_s)
    placed = upto > 0 and level_backwards(boot, samples, upto, step_s)
    if not placed and len(samples) * step_s < SOUGHT_S:
        return None
    crossed = placed and len(known.edge)
    found = [cross(boot, node, known.edge, edge_of(t, boot, samples[0]))] if crossed else []
    boot = boot if placed else known.boot
    known = known._replace(t=t, told_t=t, unplaced=samples[:0], edge=known.edge[:0], boot=boot)
    return found, known, samples


def _cut(
    boot: Boot, node: str, span: tuple[float, float], cut_s: float, unsure: tuple[float, float, float]
) -> tuple[list[InertialDisplacement], float]:
    """Cut a boot's way.

    Args:
        boot: changed in place: it counts from there.
        node: whose it is.
        span: when its way was cut last, and when it is cut now (s).
        cut_s: the latter by the boot's own count, see `footholds.due_s`.
        unsure: as `plausible_displacement` takes it: variance of its place (m²), by how much its way may be
            too long in all (m), and what the pace of its clock is off by.

    Returns:
        The displacement, unless it is nonsense; and by how much its way may be too long after it (m).
    """
    stands = cut_s <= boot.footholds[LAST_S]
    place = place_at(boot.footholds, cut_s) if stands else boot.held.place.copy()
    beyond = boot.held.place - place
    # What both navigations are apart by now has to be told with it.
    boot.held.place[:], boot.comparison[:3] = place, boot.comparison[:3] - beyond
    unsure_m2, stretched_m, pace_sigma = unsure
    unsure_m2 += 0.0 if stands else AWAY_M**2
    some, stretched_m = plausible_displacement(boot, node, span, unsure_m2, stretched_m, pace_sigma)
    boot.held.place[:] = beyond
    boot.comparison[:3] += beyond - place
    boot.footing[FOOTHOLD_M] -= place[2]
    boot.unheld[3:] = 0.0
    boot.footing[FLAT_M2] = 0.0
    boot.comparison[MOVED_M2 : MOVED_M2 + 2] = boot.gyros[CHANGED] = boot.known[TURNED_RAD2] = 0.0
    if boot.gyros[RESTED_S] > TOLD_AFTER_S:
        boot.gyros[RESTED_S] = 0.0
    count_from(boot.footholds, cut_s, place)
    return some, stretched_m
