"""Displacements of which nobody says since when: copies of others, and those after some that were lost.

Such a displacement is what its unit has moved since its last one, which may never have come; and two gateways
that hear it stamp it by clocks of their own, so that it seems to be two.
"""

import math
from collections.abc import Sequence

from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.learned.report_period import SPANS_LEAST, Cadence, Reported, is_whole
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.coasting import mark_after, onward_m
from estimator.fusion.motion.recent_places import Mark
from estimator.fusion.motion.silence import SILENT_S, went_on
from estimator.fusion.motion.steps import FIRST_DURATION_S
from estimator.fusion.readings.same_epoch import COPY, joined, says_the_same
from estimator.inertial.displacement import InertialDisplacement
from estimator.measurements.displacement import Displacement

SOON = 0.75
"""A copy comes in less of its original's time; the next report that says the same by chance does not."""
SOONER = 0.3
"""The same of a unit that repeats itself."""
COARSE_M = 0.05
"""A unit that tells its bearer's steps, at no times of its own, in whole lengths of this repeats itself."""
TIMELY = 0.08
"""How far off a unit's own time its reports come, in times between two of them."""
FEW, EVEN = 10, 0.03
"""Of a unit hardly known the usual time may be so many of its own, and is then a whole number as closely."""
BELIEVED = -math.log(9.0)
"""Reports are taken to be lost unless it is as unlikely: then their bearer is shown surer of his place."""
MORE = 1.5
"""So many periods after the one before, a report leaves out another."""
PACE_MPS, FULL = 0.3, 0.75
"""Who walks, and as fast as usual: of those who stop and set off one in sixteen seems to, by chance."""
PACE_M = 0.3
"""Who has not gone on so far would show nothing by whether his way is told afterwards."""


def with_starts(state: FusionState, readings: Sequence[Displacement]) -> list[Displacement]:
    """Say of a tick's displacements since when they are, where it is told by how their units report.

    Args:
        state: the fusion: is told what its units' reports have shown, and counts copies as not fused.
        readings: in canonical order.

    Returns:
        One of each unit and epoch, in order of epoch; one after a loss begins where those that were lost end.
    """
    return [told for reading in joined(state, readings) if (told := _begun(state, reading)) is not None]


def _begun(state: FusionState, reading: Displacement) -> Displacement | None:
    node = state.nodes.get(reading.node)
    if reading.from_t is not None or type(reading) is InertialDisplacement:
        return reading
    if node is None or node.mode == "retired":
        return reading
    cadence = node.cadence if node.unit_t is not None else Cadence()
    since_s = reading.t - cadence.recent[-1].t if cadence.recent else FIRST_DURATION_S
    if since_s <= 0.0:
        return reading
    told = Reported(reading.t, since_s, reading.delta_m, reading.heading_rad)
    if cadence.recent and is_copy(cadence, told):
        text = f"two gateways report the displacements of {reading.node} at different epochs: they count once"
        state.say("conflict", reading.t, reading.node, text, once=f"copies of {reading.node}")
        state.count("not_fused")
        return None
    # No period is shorter than the shortest time between two reports.
    soon = since_s <= MORE * min(cadence.spans_s, default=math.inf)
    period_s, losing, from_t = None if soon else cadence.period_s, 0.0, None
    left_out = period_s is not None and since_s > MORE * period_s and is_whole(since_s / period_s)
    if period_s is not None and left_out and (cadence.stands or walks_on(cadence, told, period_s)):
        odds = odds_of_loss(cadence, told, period_s)
        if math.hypot(*onward_m(marks_of(cadence), since_s - period_s, 0.0)) > PACE_M:
            losing = odds
        if cadence.losing + odds > BELIEVED:
            from_t = reading.t - period_s
            told = told._replace(own_s=period_s)
    still = told.own_s <= SILENT_S and math.hypot(*reading.delta_m) < physics.STILL_MPS * told.own_s
    after = cadence.after(told, still=still, losing=losing)
    state.nodes[node.node] = replace(node, cadence=after)
    return reading if from_t is None else replace(reading, from_t=from_t)


def is_copy(cadence: Cadence, told: Reported) -> bool:
    """Whether a report is one that has come before, by another clock.

    Args:
        cadence: what its unit has reported, at least one.
        told: the report.
    """
    last = cadence.recent[-1]
    whole_of_it = told.heading_rad is not None and math.hypot(*told.delta_m) > COPY
    # Who walks evenly reports the same again, but at his unit's own time.
    waited_s = told.t - last.t
    if says_the_same(last, told):
        usual_s = cadence.usual_s
        soon = SOONER if repeats_itself(cadence, told) else SOON
        if usual_s is not None and waited_s < soon * usual_s:
            own = len(cadence.spans_s) < SPANS_LEAST or is_timely(waited_s, cadence.middle_s)
            return not (own and left_some_out(usual_s / waited_s))
        period_s = cadence.period_s
        return whole_of_it and period_s is not None and not is_whole(waited_s / period_s)
    # One that is older than another has to be the same in every number, of which a heading is one. Units
    # round them: what comes at its unit's own time is told by it, though it has told the same before.
    # Hardly any says the same: what its unit's time is need not be asked.
    if not whole_of_it or not any(says_the_same(one, told) for one in cadence.recent[:-1]):
        return False
    timely = is_timely(waited_s, cadence.period_s or cadence.usual_s)
    return not timely and not repeats_itself(cadence, told)


def repeats_itself(cadence: Cadence, told: Reported) -> bool:
    """Whether a unit says the same again and again: it tells its bearer's steps, at no times of its own.

    Args:
        cadence: what it has reported.
        told: its newest report.
    """
    return not cadence.stands and is_coarse(told) and cadence.period_s is None


def is_coarse(told: Reported) -> bool:
    """Whether a report is in whole lengths so long that its unit's steps agree by chance, again and again."""
    return all(abs(along - COARSE_M * round(along / COARSE_M)) < COPY for along in told.delta_m)


def is_timely(waited_s: float, between_s: float | None) -> bool:
    """Whether a report comes some whole times of the time between two after another (None: not known)."""
    if between_s is None or waited_s < 0.5 * between_s:
        return False
    return abs(waited_s / between_s - round(waited_s / between_s)) <= TIMELY


def left_some_out(times: float) -> bool:
    """Whether what was seen of a unit so far may have left out some of its reports.

    Args:
        times: the usual time between those that came, in times since the last one.
    """
    return times < FEW + EVEN and abs(times - round(times)) <= EVEN


def walks_on(cadence: Cadence, told: Reported, period_s: float) -> bool:
    """Whether somebody walks as fast at both ends of a pause as before it.

    Who has stood in it stops and sets off within a period, and tells of a part of a way on both sides.

    Args:
        cadence: what his unit has reported before it, at least one.
        told: the first report after it.
        period_s: his unit's period (s).
    """
    paces_mps = [math.hypot(*one.delta_m) / one.own_s for one in cadence.recent]
    usual_mps = sorted(paces_mps)[len(paces_mps) // 2]
    slowest_mps = min(paces_mps[-1], math.hypot(*told.delta_m) / period_s)
    return usual_mps > PACE_MPS and slowest_mps > FULL * usual_mps


def odds_of_loss(cadence: Cadence, told: Reported, period_s: float) -> float:
    """Log odds that a displacement is that of its unit's last period, not of all the time since the last one.

    Its bearer goes on at his pace, which is forgotten (`silence.went_on`): both tell a mean and a variance.

    Args:
        cadence: what its unit has reported before.
        told: the displacement, as of all the time since the last one that came.
        period_s: its unit's period (s).
    """
    marks, gap_s = marks_of(cadence), told.own_s - period_s
    whole, missed = onward_m(marks, told.own_s, 0.0), onward_m(marks, gap_s, 0.0)
    last = tuple(one - other for one, other in zip(whole, missed, strict=True))
    of_all_m2 = went_on(told.own_s)[1]
    # By then his pace is another one.
    kept_s, own_m2 = went_on(period_s)
    forgotten = -math.expm1(-2.0 * gap_s / physics.UNHEARD_MEMORY_S)
    of_last_m2 = own_m2 + (kept_s * physics.SILENT_SPEED_MPS) ** 2 * forgotten
    by_last = _log_likelihood(told.delta_m, last, of_last_m2)
    return by_last - _log_likelihood(told.delta_m, whole, of_all_m2)


def _log_likelihood(delta_m: Vector3, mean_m: Sequence[float], variance_m2: float) -> float:
    """Of a displacement in the plane; what is common to all is left out."""
    off_m2 = (delta_m[0] - mean_m[0]) ** 2 + (delta_m[1] - mean_m[1]) ** 2
    return -0.5 * off_m2 / variance_m2 - math.log(variance_m2)


def marks_of(cadence: Cadence) -> list[Mark]:
    """The newest reports as a way without what none of them tells: epochs, and displacements summed up."""
    marks: list[Mark] = [(0.0, 0.0, 0.0, 0.0)]
    for told in cadence.recent:
        marks.append(mark_after(marks[-1], marks[-1][0] + told.own_s, told.delta_m))
    return marks
