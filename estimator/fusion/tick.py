"""One tick of the default tracker: what happens to its readings, in this order."""

import math
from collections.abc import Sequence
from operator import itemgetter

from estimator.fusion.entering import (
    corrections,
    late_introductions,
    leaving,
    reentry,
    replaced_unit,
)
from estimator.fusion.holding import EPOCH, HELD, covered, hold, names_of, parts_of
from estimator.fusion.memory.state import AnyHeld, FusionState
from estimator.fusion.motion.dead_reckoning import drift_units, was_silent
from estimator.fusion.readings import absolute, raw_samples
from estimator.fusion.readings.clocks import retimed
from estimator.fusion.readings.copies import without_copies
from estimator.fusion.readings.crossings import hear
from estimator.fusion.readings.displacements import move_units, returns
from estimator.fusion.readings.leading_units import leading
from estimator.fusion.readings.unseen_rises import another as another_altimeter
from estimator.fusion.readings.unstated_starts import with_starts
from estimator.fusion.report import estimate_of
from estimator.fusion.rows.rows import Single
from estimator.inertial.samples import AnyFolded, Samples
from estimator.measurements.displacement import Awaited, Displacement
from estimator.measurements.node import LateNode, Node
from estimator.measurements.position import Position
from estimator.measurements.retire import Retire
from estimator.measurements.rssi import Rssi


def fold_tick(state: FusionState, until_t: float, readings: Sequence[AnyFolded]) -> None:
    """Fold the readings of one tick into the state; what is noticed stands in its `notices`.

    Args:
        state: changed in place.
        until_t: end of the tick, Unix seconds.
        readings: in canonical order, see `canonical_order`.
    """
    state.notices, state.announced = [], {}
    state.newest_t = max(state.newest_t, until_t)
    displacements: list[Displacement] = []
    holds: list[AnyHeld] = list(state.waiting)
    powers: list[Rssi] = []
    retired, returned = list[Retire](), list[Node]()
    readings = without_copies(state, readings)
    for reading in readings:
        if type(reading) is Awaited:
            state.awaited[reading.node] = reading
            continue
        if state.called and isinstance(reading, (*HELD, Displacement, Samples)):
            for name in names_of(reading):
                reentry.re_enter(state, name, reading.t)
        # The commonest but `HELD`, of which it would be asked eight times in vain whether it is one of them.
        if type(reading) is Displacement:
            displacements.append(reading)
        elif isinstance(reading, HELD):
            if isinstance(reading, Rssi):
                powers.append(reading)
            holds.append(retimed(reading, state.clocks, state.nodes) if state.clocks else reading)
        elif isinstance(reading, Node) and any(r.node == reading.node and r.t < reading.t for r in retired):
            returned.append(reading)
        elif isinstance(reading, Node):
            holds += _introduced(state, reading)
        elif isinstance(reading, Retire):
            retired.append(reading)
        elif isinstance(reading, Samples):
            displacements += raw_samples.displacements_of(state, reading)
    holds += hear(state, powers)
    displacements = leading(state, with_starts(state, displacements))
    holds.sort(key=EPOCH)
    gone_out = {r.node for r in retired}
    for name, changed_t in state.announced.items():
        # What the old unit has told of leads up to where the new one is put on.
        early = [r for r in displacements if r.node == name and r.t <= changed_t]
        displacements = [r for r in displacements if r.node != name or r.t > changed_t]
        _fold(state, early, [], until_t, {name})
        replaced_unit.change(state, name)
        another_altimeter(state, name, changed_t)
    while back := returns(state, displacements):
        # What was heard of who was silent is not held against where his unit has taken him since.
        name, back_t = min(back.items(), key=itemgetter(1))
        early = [r for r in displacements if r.t <= back.get(r.node, math.inf)]
        displacements = [r for r in displacements if r.t > back.get(r.node, math.inf)]
        _fold(state, early, [r for r in holds if r.t <= back_t], until_t, {name})
        holds = [*state.waiting, *(r for r in holds if r.t > back_t)]
        drift_units(state, {name: back_t}, onward=True)
        state.suspected = state.suspected or was_silent(state.nodes[name])
    _fold(state, displacements, holds, until_t, gone_out)
    for gone in retired:
        leaving.retire(state, gone, estimate_of(state, gone.node))
    for reading in returned:
        _introduced(state, reading)
    state.keep_poses()


def _introduced(state: FusionState, reading: Node) -> list[Position]:
    if isinstance(reading, LateNode):
        return late_introductions.take(state, reading)
    return corrections.take(state, reading)


def _fold(
    state: FusionState,
    displacements: Sequence[Displacement],
    holds: Sequence[AnyHeld],
    until_t: float,
    unwaited: set[str],
) -> None:
    """Move units, and hold against everybody's places what nothing is to be waited for.

    Args:
        state: the fusion: takes readings that wait.
        displacements: in order of epoch.
        holds: all others, in order of epoch.
        until_t: newest epoch (s).
        unwaited: nodes for whose displacements nothing waits.
    """
    singles: list[Single] = []
    holds = _begin_at_fixes(state, holds)
    move_units(state, displacements, singles)
    ready = covered(state, holds, until_t, unwaited)
    for part in parts_of(state, ready):
        if part or singles:
            hold(state, part, singles)
            singles = []


def _begin_at_fixes(state: FusionState, readings: Sequence[AnyHeld]) -> list[AnyHeld]:
    """Let those begin whose first place a fix tells: they are not taken to be at the base first.

    Returns:
        The readings that are still to be held.
    """
    if Position not in map(type, readings):
        return list(readings)
    others: list[AnyHeld] = []
    for reading in readings:
        if isinstance(reading, Position):
            node = state.nodes.get(reading.node)
            if node is None or node.mode == "undecided":
                absolute.fix(state, reading)
                begun = state.nodes.get(reading.node)
                if begun is None or begun.role != "uav" or not begun.decided:
                    continue
        others.append(reading)
    return others
