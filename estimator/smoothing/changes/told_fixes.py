"""Fixes of somebody who flies that are off by more than is told, or are told later than is usual.

Where nothing but his fixes tells where anybody is, all are off by what these are, and no reading shows it.
With a base, anchors or units that turn it pulls, as a told place does: what everything else says of it is
held against what is usual, and against the other kind, see `told_places`.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.receivers import LATE, OFFSET, Receiver
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.variable import Variable
from estimator.smoothing.changes.told_places import CLEARER, LEAST_M, judged
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

WIDE = ((OFFSET, physics.MISTOLD_SIGMA_M), (LATE, physics.LATER_SIGMA_S))
"""How far they are off (m), or late (s), if they are of the other kind."""
RARELY = math.log(physics.MISLED / (1.0 - physics.MISLED))
DOUBTED = 0.0
"""Log odds from which on it is asked what else may explain the same."""
LEAST_S, SURELY = 0.4, 3.0
"""Fixes are put to when they were that are later by so many standard deviations."""


class ToldFixes(NamedTuple):
    """What everything else says of what fixes are off by, or of how late they are.

    Attributes:
        name: of the receiver.
        own: which of its numbers.
        odds: log odds that they are of the other kind.
        off: what they then are, beyond what is expected: east, north (m), or late (s).
        moment: second moment, about what they are thought to be, of what they are if they are of the other
            kind, less their covariance if they are not.
        thought: what they are thought to be, beyond what is expected.
        sigma: standard deviations of that.
    """

    name: str
    own: slice
    odds: float
    off: Array
    moment: Array
    thought: Array
    sigma: Array

    @property
    def stands_out(self) -> bool:
        """Whether they are off by more than is usual, or are surely late."""
        if self.own == LATE:
            return abs(float(self.thought[0])) - SURELY * float(self.sigma[0]) > LEAST_S
        return self.odds > physics.MODE_MARGIN and float(np.linalg.norm(self.off)) > LEAST_M

    @property
    def known_by(self) -> str:
        """What its odds are known by among those of other causes."""
        return f"{self.name} {self.own.start}"


def ask_told_fixes(problem: Problem, solved: Solution) -> list[ToldFixes]:
    """How likely fixes are to be off or late otherwise than is usual, the likeliest first.

    Args:
        problem: of a window, or of the whole incident.
        solved: its solution, at rest.
    """
    layout = problem.layout
    state, size = layout.state, layout.length * layout.width
    held = {
        state.sources[number]: at for (kind, number), at in layout.technologies.items() if kind == "receiver"
    }
    if not held:
        return []
    solved.chain.reduce()
    border, found = solved.chain.border_covariance(), []
    for name, start in held.items():
        known = state.receivers[name]
        for own, wide in WIDE:
            at, sigma = slice(start + own.start, start + own.stop), np.array(known.sigma[own])
            if sigma[0] < wide:
                pull = solved.x[size:][at] - known.mean[own]
                unsure = np.sqrt(np.diag(border)[at])
                told = judged(name, 0, pull, border[at, at], sigma, wide, RARELY)
                found.append(ToldFixes(name, own, told.odds, told.off_m, told.moment_m2, pull, unsure))
    return sorted(found, key=lambda one: -one.odds)


def doubt_fixes(state: FusionState, found: Sequence[ToldFixes], others: Mapping[str, float]) -> None:
    """Let covariances hold that fixes may be of the other kind.

    Args:
        state: the fusion, whose receivers take it.
        found: all that was asked.
        others: log odds of what else may explain the same.
    """
    state.receivers = {name: known.believed() for name, known in state.receivers.items()}
    for one, moment in shared_moments(found, others):
        known = state.receivers[one.name]
        if one.own == OFFSET:
            (ee, en), (_, nn) = moment.tolist()
            state.receivers[one.name] = replace(known, elsewhere_m2=(ee, en, nn))
        else:
            state.receivers[one.name] = replace(known, later_s2=float(moment[0, 0]))


def shared_moments(found: Sequence[ToldFixes], others: Mapping[str, float]) -> list[tuple[ToldFixes, Array]]:
    """The moments of all, each as likely as it is; arguments as above."""
    known = np.array([0.0, *(one.odds for one in found), *others.values()])
    shares = np.exp(known - known.max())
    shares /= shares.sum()
    return [(one, share * one.moment) for one, share in zip(found, shares[1:].tolist(), strict=False)]


def misled(found: Sequence[ToldFixes], others: Mapping[str, float]) -> ToldFixes | None:
    """What stands out, against all being as usual and all other causes.

    Args:
        found: all that was asked.
        others: see `doubt_fixes`.
    """
    for one in found:
        rivals = [other.odds for other in found if other is not one] + list(others.values())
        # That fixes are late is a state already: it is to be no other's fault.
        clearer = 0.0 if one.own == LATE else CLEARER
        if one.stands_out and one.odds > max(rivals, default=-math.inf) + clearer:
            return one
    return None


def allow(state: FusionState, one: ToldFixes) -> None:
    """Let fixes be off by anything, or put them to when they were.

    Args:
        state: the fusion, changed in place; its window is then to be solved again.
        one: what is of the other kind.
    """
    known = state.receivers[one.name]
    sigma = list(known.sigma)
    for own, wide in WIDE:
        if own == one.own:
            sigma[own] = [wide] * (own.stop - own.start)
    key = ("receiver", state.source(one.name))
    if state.prior is not None:
        less = np.array(known.sigma) ** -2.0 - np.array(sigma) ** -2.0
        state.prior = state.prior.without(key, known.mean, less)
    east, north, up, late = sigma
    state.receivers[one.name] = replace(known, sigma=(east, north, up, late)).believed()
    state.due = True
    if one.own == LATE:
        _put_back(state, one.name, known, float(one.thought[0]))
        return
    off_m = float(np.hypot(*one.off))
    text = f"fixes of {known.node} are off by about {off_m:.0f} m: that is allowed for, look at its receiver"
    state.say("outlier", state.newest_t, known.node, text)


def _put_back(state: FusionState, name: str, known: Receiver, late_s: float) -> None:
    """Let fixes count from when they were: what is left of how late they are is nil."""
    number = state.source(name)
    state.receivers[name] = replace(state.receivers[name], late_s=known.late_s + late_s)
    singles = state.ledger.table("singles").copy()
    singles[singles[:, 6] == number, 0] -= late_s
    state.ledger.replace("singles", singles[np.argsort(singles[:, 0], kind="stable")])
    row = state.graph.starts[Variable("receiver", name)] + LATE.start
    state.graph = state.graph.moved(row, -late_s)
    if state.prior is not None:
        state.prior = state.prior.moved(("receiver", number), LATE.start, -late_s)
    all_s = known.late_s + late_s
    off = f"{abs(all_s):.1f} s {'late' if all_s > 0.0 else 'early'}"
    text = f"fixes of {known.node} are told {off}: that is allowed for, set its clock"
    state.say("conflict", state.newest_t, known.node, text)
