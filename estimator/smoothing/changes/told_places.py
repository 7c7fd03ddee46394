"""Places that were told of what stands, and are wrong: an anchor that somebody has put elsewhere.

The map bends until ranges to such a radio fit, and no residual need stand out. What stands out is the pull
that the told place takes: held against what everything else says of that place alone, it is off by more than
both vary by. Of each told place it is asked by itself how much likelier all is if that one is free. From the
solution's own covariance that follows without another solution: with Σ of the place, of which its told prior
Λ is a part, everything else says C⁻¹ = Σ⁻¹ − Λ (leave-one-out residuals; Cook, Weisberg: Residuals and
influence in regression, 1982).
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.modes import find_modes
from estimator.fusion.learned.told_places import MistoldPlace
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.state import FusionState
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.changes.relocation import readings_of
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

RARELY = math.log(physics.MISTOLD / (1.0 - physics.MISTOLD))
DOUBTED = math.log(0.03)
"""Log odds from which on a place is doubted at all: where readings tell next to nothing they are fewer."""
CLEARER, LEAST_M = 4.0, 1.0
"""The one that is wrong is likelier by so much than any other cause (log odds), and so far off at least."""
RANGES = 12
"""Of fewer ranges it is not asked whether most of them are outliers."""
LEAST = 1e-6
"""Information (m⁻²) on a place of which nothing else tells: a kilometre."""


class ToldPlace(NamedTuple):
    """What everything else says of a told place.

    Attributes:
        name: of the node.
        number: of it in the ledger.
        odds: log odds that it is wrong and all others are right, against that all are right.
        off_m: how far from there it stands if it is wrong: east, north (m).
        moment_m2: second moment, about where it is thought to be, of where it stands if it is wrong, less its
            covariance if it is right, 2 × 2 (m²).
    """

    name: str
    number: int
    odds: float
    off_m: Array
    moment_m2: Array


def ask_told_places(problem: Problem, solved: Solution) -> list[ToldPlace]:
    """How likely each told place is to be wrong, the likeliest first; only of radios that are ranged.

    Radios differ in what they send and hear by several dB, as much as a few metres make: powers alone cannot
    tell a weak radio from one that stands elsewhere.

    Args:
        problem: of a window, or of the whole incident.
        solved: its solution, at rest.
    """
    layout = problem.layout
    state, size = layout.state, layout.length * layout.width
    surely = state.ledger.table("stands")
    surely = surely[surely[:, 5] < physics.MISTOLD_SIGMA_M]
    pairs = problem.rows.pairs
    ranged = set(pairs[pairs[:, 1] == RANGE, 2:4].ravel().tolist())
    stands = [row for row in surely if row[1] in ranged and _asked(state, int(row[1]))]
    if not stands:
        return []
    solved.chain.reduce()
    border, found = solved.chain.border_covariance(), []
    for row in stands:
        number, start = int(row[1]), layout.stands[int(row[1])]
        own = slice(start, start + 2)
        pull_m = solved.x[size + start : size + start + 2] - row[2:4]
        place = judged(state.owners[number], number, pull_m, border[own, own], row[5:7])
        found.append(_unbelieved(problem, solved, place, row) or place)
    return sorted(found, key=lambda one: -one.odds)


def is_doubted(places: Sequence[ToldPlace]) -> bool:
    """Whether any told place may be wrong at all."""
    return bool(places) and places[0].odds > DOUBTED


def judged(
    name: str,
    number: int,
    pull_m: Array,
    covariance_m2: Array,
    sigma_m: Array,
    wide_m: float = physics.MISTOLD_SIGMA_M,
    rarely: float = RARELY,
) -> ToldPlace:
    """What everything else says of a told place, or of other numbers that were told.

    Args:
        name: of the node.
        number: of it in the ledger.
        pull_m: where it is thought to be, less where it was told to be: east, north (m).
        covariance_m2: of that place, its told prior included, 2 × 2 (m²).
        sigma_m: of that prior: east, north (m).
        wide_m: of each, if it is wrong (m).
        rarely: log odds that it is, before anything is known.
    """
    known = np.linalg.inv(covariance_m2)
    values, vectors = np.linalg.eigh(known - np.diag(sigma_m**-2.0))
    others = (vectors * np.maximum(values, LEAST)) @ vectors.T
    apart = np.linalg.inv(others)
    off_m = apart @ known @ pull_m
    right, wrong = apart + np.diag(sigma_m**2), apart + np.eye(len(sigma_m)) * wide_m**2
    gain = 0.5 * float(off_m @ (np.linalg.solve(right, off_m) - np.linalg.solve(wrong, off_m)))
    rarer = 0.5 * (np.linalg.slogdet(wrong)[1] - np.linalg.slogdet(right)[1])
    freed = np.linalg.inv(others + np.eye(len(sigma_m)) / wide_m**2)
    there_m = freed @ others @ off_m
    gone_m = there_m - pull_m
    moment = np.outer(gone_m, gone_m) + freed - covariance_m2
    return ToldPlace(name, number, gain - float(rarer) + rarely, there_m, moment)


def doubts_of(places: Sequence[ToldPlace], delays: Mapping[str, float]) -> dict[str, MistoldPlace]:
    """What is to be told of places that may be wrong.

    Args:
        places: all that were asked, the likeliest first.
        delays: log odds that the radio of a node has an antenna delay, which may explain the same.
    """
    if not is_doubted(places):
        return {}
    known = np.array([0.0, *(one.odds for one in places), *delays.values()])
    shares = np.exp(known - known.max())
    shares /= shares.sum()
    found = {}
    for one, share in zip(places, shares[1:].tolist(), strict=False):
        (ee, en), (_, nn) = (share * one.moment_m2).tolist()
        found[one.name] = MistoldPlace(ee, en, nn)
    return found


def mistold(places: Sequence[ToldPlace], delays: Mapping[str, float]) -> ToldPlace | None:
    """The one told place that is wrong, if it stands out against all being right and all other causes.

    Whether it is the place or an antenna delay at the same place, as long as that is less likely, its ranges
    are not to be believed.

    Args:
        places: see `doubts_of`.
        delays: see `doubts_of`.
    """
    if not is_doubted(places):
        return None
    best, *others = places
    own = delays.get(best.name, -math.inf)
    rivals = [one.odds for one in others] + [odds for name, odds in delays.items() if name != best.name]
    least = max(physics.MODE_MARGIN, max(rivals, default=-math.inf) + CLEARER)
    clear = np.logaddexp(best.odds, own) > least
    there = float(np.hypot(*best.off_m)) > LEAST_M
    return best if clear and there and best.odds > own else None


def free(state: FusionState, place: ToldPlace, delay: float = -math.inf) -> None:
    """Let something stand elsewhere than it was told to: what was told of its place counts for little.

    Args:
        state: the fusion, changed in place; its window is then to be solved again.
        place: the told place.
        delay: log odds that its radio has an antenna delay instead.
    """
    stands = state.ledger.table("stands").copy()
    (at,) = np.flatnonzero(stands[:, 1] == place.number)[:1]
    told, wide = stands[at, [2, 3, 5, 6]].tolist(), physics.MISTOLD_SIGMA_M
    stands[at, 5:7] = wide
    state.ledger.replace("stands", stands)
    if state.prior is not None:
        less = np.array([sigma_m**-2 - wide**-2 for sigma_m in told[2:]])
        state.prior = state.prior.without(("stand", place.number), np.array(told[:2]), less)
    node = state.life(place.number)
    state.keep(replace(node, absolute=replace(node.absolute, disbelieved_m=told[2])))
    state.mistold = {}
    # What was learned beside a wrong place was learned of it.
    state.noise = {}
    for walker in list(state.nodes.values()):
        if walker.mode == "unit":
            state.keep(replace(walker, walk_factors=(1.0, 1.0)))
    state.due = True
    off_m = float(np.hypot(*place.off_m))
    text = f"{place.name} does not stand where it was told to: about {off_m:.0f} m off; tell where it stands"
    if delay > place.odds - CLEARER:
        text = f"{place.name} stands elsewhere than was told, or its ranges are off; tell where it stands"
    state.say("node_moved", state.newest_t, place.name, text)


def believe(state: FusionState) -> None:
    """Take back that told places are wrong: whoever knows more may judge it otherwise.

    Args:
        state: the fusion, changed in place; nothing has left its window.
    """
    stands = state.ledger.table("stands").copy()
    for node in list(state.nodes.values()):
        sigma_m = node.absolute.disbelieved_m
        if sigma_m is not None:
            stands[stands[:, 1] == node.index, 5:7] = sigma_m
            state.keep(replace(node, absolute=replace(node.absolute, disbelieved_m=None)))
    state.ledger.replace("stands", stands)


def _asked(state: FusionState, number: int) -> bool:
    node = state.life(number)
    return node.absolute.believed_m is not None and node.index == number and node.mode == "static"


def _unbelieved(problem: Problem, solved: Solution, place: ToldPlace, row: Array) -> ToldPlace | None:
    """The same of a radio most of whose ranges are outliers: they pull nothing, and bend no map."""
    pairs = problem.rows.pairs
    mine: Integers = np.flatnonzero(
        ((pairs[:, 2] == place.number) | (pairs[:, 3] == place.number)) & (pairs[:, 1] == RANGE)
    )
    if len(mine) < RANGES or solved.weighted.good[mine].mean() > 0.5:
        return None
    node = problem.layout.state.life(place.number)
    seen = readings_of(problem, solved, node, mine)
    modes = find_modes(seen.sought) if seen is not None else []
    if seen is None or not modes:
        return None
    best, off_m = modes[0], modes[0].position_m[:2] - row[2:4]
    gain = float((seen.costs(seen.residual) - seen.costs(seen.residual_at(best.position_m))).sum())
    wide = physics.MISTOLD_SIGMA_M
    gain -= 0.5 * float(off_m @ off_m) / wide**2 + 2.0 * math.log(wide / max(best.sigma_m, 0.01))
    # Its ranges bend nothing: nobody is elsewhere by them.
    return place._replace(odds=max(gain + RARELY, place.odds), off_m=off_m, moment_m2=np.zeros((2, 2)))
