"""Displacements of PDR units as they are taken in, all those of a tick together."""

import math
from collections.abc import Sequence

from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.base_entry import begin_at_base, may_be_inside, waits_for_ranges
from estimator.fusion.entering.guesses import forget_place, is_guessed_to_stand
from estimator.fusion.entering.introduce import attach_unit
from estimator.fusion.entering.replaced_unit import begin_frame, framed
from estimator.fusion.memory.ledger import ASSUMED, CLAIMED
from estimator.fusion.memory.state import Count, FusionState
from estimator.fusion.motion.changed_gait import change_gait
from estimator.fusion.motion.dead_reckoning import advance_units
from estimator.fusion.motion.steps import TRAIL_S, Step, start_of
from estimator.fusion.readings.gyro_biases import enter, weigh_anew
from estimator.fusion.rows.rows import Single
from estimator.inertial.displacement import InertialDisplacement
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import MOVING_ROLES


def move_units(state: FusionState, readings: Sequence[Displacement], biases: list[Single]) -> None:
    """Fold a tick's displacements: one transition for all units at once, and ZARU where they stand still.

    Args:
        state: the fusion.
        readings: in order of epoch.
        biases: takes the gyro biases that units tell.
    """
    steps: dict[str, Step] = {}
    for reading in readings:
        begin_frame(state, reading)
        step = steps.get(reading.node) or _begin(state, reading)
        if step is None:
            _count(state, reading, "not_fused")
            continue
        steps[reading.node] = step
        if step.node.raw != (type(reading) is InertialDisplacement):
            set_aside(state, reading.node, reading.t)
            _count(state, reading, "not_fused")
        elif _extend(state, step, framed(step.node, reading), biases):
            _count(state, reading, "fused")
    moving = [step for step in steps.values() if step.taken]
    if moving:
        advance_units(state, moving)
    trail_s = _waited_s(state)
    for name, step in steps.items():
        state.nodes[name] = step.after(trail_s)


def _waited_s(state: FusionState) -> float:
    """For how long readings may wait for anybody: so long the ways of who is at their other ends are kept."""
    waits = [node.wait_s for node in state.nodes.values() if node.mode == "unit" and not node.raw]
    return max((TRAIL_S, *waits, *(one.told_t - one.t for one in state.awaited.values())))


def set_aside(state: FusionState, name: str, t: float) -> None:
    """Say that a bearer's way is told twice: by his unit, and by raw samples. What came first leads him."""
    text = f"both displacements and inertial samples tell of {name}: only those that came first are used"
    state.say("conflict", t, name, text, once=f"two units of {name}")


def _begin(state: FusionState, reading: Displacement) -> Step | None:
    """The step that a unit's first displacement in a tick begins; None where its node is not to move."""
    node = state.node_of(reading.node, "responder", reading.t)
    if is_guessed_to_stand(node):
        forget_place(state, node, moves=True)
        node = replace(state.nodes[node.node], role="responder")
    if node.role not in MOVING_ROLES or node.mode == "retired":
        text = f"{node.node} is a {node.mode} {node.role}: its displacement is set aside"
        state.say("conflict", reading.t, node.node, text, once=f"displacement of {node.node}")
        return None
    if node.mode == "undecided":
        state.nodes[node.node] = node = replace(node, whole_t=min(node.whole_t, reading.t))
        if waits_for_ranges(state, node, reading.t):
            # Where he may be inside it takes a moment to hear him.
            if reading.t > node.whole_t + physics.MOVING_SIGHTINGS_S or not may_be_inside(
                state, node, reading.t
            ):
                text = f"nobody said where {node.node} entered: its displacements wait for ranges that tell"
                state.say("not_fused", reading.t, node.node, text, once=f"{node.node} waits for ranges")
            return None
        begin_at_base(state, node, start_of(reading, None))
    if state.nodes[node.node].mode == "free":
        attach_unit(
            state, state.nodes[node.node], reading.heading_rad, isinstance(reading, InertialDisplacement)
        )
    return Step(state.nodes[node.node])


def _count(state: FusionState, reading: Displacement, what: Count) -> None:
    """Count a displacement, unless samples have made it, which are counted."""
    if type(reading) is not InertialDisplacement:
        state.count(what)


def returns(state: FusionState, readings: Sequence[Displacement]) -> dict[str, float]:
    """Units that report again after a silence of which they tell nothing, and since when they do (s).

    Args:
        state: the fusion.
        readings: a tick's displacements, in order of epoch.
    """
    told_until, back = dict[str, float](), dict[str, float]()
    for reading in readings:
        until_t = told_until.get(reading.node)
        if until_t is None:
            node = state.nodes.get(reading.node)
            until_t = node.pose_t if node is not None and node.mode == "unit" else math.inf
        start_t = start_of(reading, until_t)
        if start_t > until_t + physics.FREE_TICK_S:
            back.setdefault(reading.node, start_t)
        told_until[reading.node] = max(until_t, reading.t)
    return back


def _extend(state: FusionState, step: Step, reading: Displacement, biases: list[Single]) -> bool:
    node, straight = step.node, step.straight
    increment = step.take(reading)
    if increment is None:
        text = f"{node.node} reported another displacement that covers this one's epoch, which is set aside"
        once = f"epochs of {node.node}"
        if step.tells_again(reading):
            once = f"from_t of {node.node}"
            text = f"{node.node} reports again since {reading.from_t} s, of which it has told before: that "
            text += "is set aside, and the position goes on without it; look at from_t of its gateway"
        elif node.unit_t is None and not step.taken:
            text = f"{node.node} was placed after this displacement, which is set aside"
        state.say("conflict", reading.t, node.node, text, once=once)
        _count(state, reading, "not_fused")
        return False
    if increment.too_fast:
        text = f"{node.node} reported {math.hypot(*reading.delta_m):.1f} m at once, faster than anyone runs"
        if not any(increment.delta_m):
            text += (
                ": that tells nothing of where the bearer is; look at the unit, and at what its gateway tells"
            )
        state.say("outlier", reading.t, node.node, text)
        state.count("outlier")
    if step.straight.has_told_more(straight):
        weigh_anew(state, node, straight, step.straight)
    biases += enter(state, node, increment.biases)
    given = ASSUMED if reading.sigma_m is None else CLAIMED
    across, _, up, turn, bias, scale = increment.noise
    variances = (across, up, turn, bias, scale, given)
    state.ledger.add("steps", reading.t, node.index, increment.since_t, *increment.delta_m, *variances)
    if increment.gait is not None:
        change_gait(state, step, increment.gait)
    return True
