"""A radio and a unit of one name that are not in one place: ranges go one way and steps another."""

import math
from collections.abc import Collection

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.separated_unit import join, part
from estimator.fusion.memory.separated_unit import SPAN_S, SeparatedUnit
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.smoothing.changes.recent_ranges import DISAGREEING, RecentRanges
from estimator.smoothing.changes.short_tracks import RangedUnit, fit_along_unit, fit_freely
from estimator.smoothing.changes.track_fit import TrackFit
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import HEADING

CLEAR, FAR_M = 12.0, 2.0
"""Log evidence from which on they are apart, and how far (root mean square): less is a wall."""
NEAR_M, GONE_M, ALIKE, FACES_RAD = 1.0, 5.0, 0.0, 0.5
"""From when on they are together again: as near, over a way as long, likelier than any other way, and faced
as the unit was."""
CORNER_M = 1.0
"""Where the unit is reckoned to be far off the way is as wide across its length, too (root mean square): two
who walk down a corridor go alike; and who has crawled for a while has been farther than his unit."""
LATE_S = (-3.0, -2.0, -1.0, 1.0, 2.0, 3.0)
"""A clock may be off: what fits so is not apart."""


def find_separated_units(state: FusionState, hearing: RecentRanges, clocked: Collection[int]) -> None:
    """Part radios from units that are not where they are, and join those that are together again.

    Args:
        state: the fusion, changed in place.
        hearing: of the window.
        clocked: walks that are not asked: their clocks have just been set.
    """
    layout, x = hearing.problem.layout, hearing.solved.x
    for i, walk in enumerate(layout.walks):
        node = state.life(walk.number)
        if walk.way is None or node.mode != "unit" or node.index != walk.number or i in clocked:
            continue
        if node.carried_t is not None:
            continue
        times, states = layout.times[:, i], layout.states(x, i)
        since_t, until_t = max(hearing.until_t - SPAN_S, node.joined_t), np.inf
        if node.apart is not None:
            known = _since(layout, x, i, node.apart)
            state.nodes[node.node] = replace(node, apart=known)
            until_t = known.marks[-1][0]
            if max(since_t, known.marks[0][0]) < known.since_t + 0.5 * SPAN_S:
                continue
            heard = hearing.heard(i, since_t, until_t, known.led)
        elif hearing.enough and hearing.ill(i, node):
            since_t = max(since_t, hearing.led_since(i))
            heard = hearing.heard(i, since_t, until_t)
        else:
            continue
        if heard is None:
            continue
        unit, free = _both(heard, states, times, node.apart is None)
        off_m = float(np.sqrt(((unit.way_m - free.way_m) ** 2).sum(axis=1).mean()))
        if node.apart is None:
            # Where two radios answer to the name, either way has half of the ranges against it.
            if free.evidence - unit.evidence > CLEAR and off_m > FAR_M and free.good > DISAGREEING:
                begin_t = float(heard.t[0])
                east, north, turn_rad = (
                    float(np.interp(begin_t, times, states[:, c])) for c in (0, 1, HEADING)
                )
                part(state, node.node, begin_t, (east, north), turn_rad)
        elif _together(node.apart, unit, free, off_m):
            join(state, node.node)


def _since(layout: Layout, x: Array, index: int, known: SeparatedUnit) -> SeparatedUnit:
    """Where radio and unit were together, as long as the window reaches there."""
    times, states = layout.times[:, index], layout.states(x, index)
    if known.since_t < times[0]:
        return known
    east, north, turn_rad = (float(np.interp(known.since_t, times, states[:, c])) for c in (0, 1, HEADING))
    return replace(known, place_m=(east, north), turn_rad=turn_rad)


def _both(heard: RangedUnit, states: Array, times: Array, late: bool) -> tuple[TrackFit, TrackFit]:
    """The likeliest way as the unit has gone, and as nobody tells; `late`: ranges may have another clock."""
    shown_m = np.column_stack([np.interp(heard.t, times, states[:, c]) for c in (0, 1)])
    turns = states[-1, HEADING] + np.linspace(0.0, 2.0 * np.pi, physics.TURNS, endpoint=False)
    unit = fit_along_unit(heard, shown_m.mean(axis=0), turns)
    stays_m = np.tile(unit.way_m.mean(axis=0), (len(heard.t), 1))
    free = fit_freely(heard, [shown_m, stays_m, unit.way_m])
    if late and free.evidence - unit.evidence > CLEAR:
        middle_m, turn = unit.way_m.mean(axis=0), np.array([unit.x[-1], states[-1, HEADING]])
        others = [fit_along_unit(heard, middle_m, turn, late_s) for late_s in LATE_S]
        unit = max([unit, *others], key=lambda fit: fit.evidence)
    return unit, free


def _together(known: SeparatedUnit, unit: TrackFit, free: TrackFit, off_m: float) -> bool:
    """Whether a radio has gone as its unit has, on a way along which that tells something."""
    gone_m = float(np.ptp(unit.way_m, axis=0).max())
    alike = free.evidence - unit.evidence < ALIKE and off_m < NEAR_M
    faces = abs(within_pi(float(unit.x[-1]) - known.turn_rad)) < FACES_RAD
    across_m = float(np.linalg.svd(unit.way_m - unit.way_m.mean(axis=0), compute_uv=False)[-1])
    turns = across_m > CORNER_M * math.sqrt(len(unit.way_m))
    return alike and faces and gone_m > GONE_M and (turns or known.reaches(free.way_m[-1]))
