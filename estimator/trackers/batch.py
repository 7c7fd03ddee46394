"""The smoothed view: the whole incident solved again with everything known now.

The online filter passes over the readings once, to decide what is fused and where to start; then all
keyframes are solved together (`estimator.smoothing`).
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from operator import attrgetter

import numpy as np

from estimator.estimate import TrackPoint
from estimator.evidence import Advice, Evidence
from estimator.fusion.beginnings import decide
from estimator.fusion.ledger import Ledger
from estimator.fusion.order import place_of
from estimator.fusion.state import FusionState
from estimator.fusion.tick import flush, fold_tick, keep_poses, names_of
from estimator.graph.robust import mixture_cost
from estimator.inertial.samples import AnyFolded, in_pieces
from estimator.measurements import AnyReading
from estimator.smoothing.advice import advise
from estimator.smoothing.branch import branch, reunite
from estimator.smoothing.elsewhere import GAIN
from estimator.smoothing.evidence import explain
from estimator.smoothing.extent import spacing_s as usual_s
from estimator.smoothing.flips import WHOLE
from estimator.smoothing.layout import Layout
from estimator.smoothing.learn import learn
from estimator.smoothing.likeliest import likeliest
from estimator.smoothing.moved import Moved, moved_nodes
from estimator.smoothing.otherwise import admit
from estimator.smoothing.rows import Rows
from estimator.smoothing.settle import keep_keyframes, settle
from estimator.smoothing.slips import withdraw
from estimator.smoothing.solve import RESTING, Problem
from estimator.smoothing.solved import Solved
from estimator.smoothing.swung import swing
from estimator.smoothing.tracks import tracks
from estimator.smoothing.window import keep_up, look_again
from estimator.trackers.base import TrackerSettings

SLACKS_M = (3.0, 1.0, 0.3, 0.1)
LEARNING = (1.5, 1.0, 0.5)
"""How far the logarithms of noise variances may move, solution by solution."""
LEARNING_RESTING = 1.0
"""What a solution may leave of its log likelihood that is only learned from."""
LONGEST_S = 86_400.0
"""No incident lasts longer: a reading farther than a day from the others has a wrong epoch."""
TICK_S = 2.0
"""The first pass only finds where to start: its ticks are longer than the online tracker's. In still longer
ones a node moves too far for the noise that is learned on the way."""
RARER = 48.0
"""The first pass only finds where to start: its window is solved this many times more rarely."""
MOVES = 20
"""So many nodes at most are found elsewhere at a time: each asks for another solution."""
UNTIL_T = attrgetter("until_t")
LARGEST = 60_000_000
"""Numbers that the chain may hold: beyond it keyframes are set farther apart."""


class BatchSmoother:
    """Solves a whole incident; see `estimator.trackers.base.Smoother`."""

    def __init__(self, settings: TrackerSettings | None = None) -> None:
        self.settings = settings or TrackerSettings()

    def smooth(self, readings: Sequence[AnyReading]) -> dict[str, list[TrackPoint]]:
        """Every node's track, a point at each whole second from its first to its last reading.

        Nodes whose position is never decided have no track.
        """
        ordered = in_order(readings)
        if not ordered:
            return {}
        state = online_pass(ordered, self.settings)
        problem, solved = solve_whole(state)
        problem, solved, modes, *_ = likeliest(problem, solved, WHOLE)
        solved.chain.solve()
        covariances = solved.chain.covariances()
        swing(problem.layout, solved, covariances)
        admit(problem.layout, solved.x, modes, covariances)
        return tracks(problem.layout, solved.x, *covariances, lifetimes(ordered))

    def evidence(self, readings: Sequence[AnyReading], node: str) -> Evidence | None:
        """What holds a node's newest fix; see `estimator.smoothing.evidence.explain`.

        Raises:
            KeyError: there is no such node.
        """
        state = online_pass(in_order(readings), self.settings)
        if state.nodes[node].mode in ("fixed", "retired") or not len(state.ledger.table("begins")):
            return None
        problem, solved = solve_whole(state)
        problem, solved, modes, *_ = likeliest(problem, solved, WHOLE)
        return explain(problem.layout.state, problem, solved, modes, node)

    def advice(self, readings: Sequence[AnyReading], node: str) -> Advice | None:
        """What would help a node most; see `estimator.smoothing.advice.advise`.

        Raises:
            KeyError: there is no such node.
        """
        return advise(online_pass(in_order(readings), self.settings), node)


def in_order(readings: Sequence[AnyReading]) -> list[AnyFolded]:
    """The readings in canonical order, without those whose epoch must be wrong."""
    ordered = sorted(in_pieces(readings), key=place_of)
    middle = ordered[len(ordered) // 2].until_t if ordered else 0.0
    first = bisect_right(ordered, middle - LONGEST_S, key=UNTIL_T)
    return ordered[first : bisect_left(ordered, middle + LONGEST_S, key=UNTIL_T)]


def solve_whole(state: FusionState) -> tuple[Problem, Solved]:
    """Solve everything, learning on the way how noisy each unit is.

    Which breadcrumbs were moved, and then which steps were reported wrongly, is asked again with all that is
    known: the first pass may have taken the one for the other, or a later epoch for that of a kick. Whether a
    technology is calibrated the first pass has judged. The same walls, met again and again for hours, look
    like a scale that is surer and surer.

    Args:
        state: the fusion after all readings, with a complete ledger; the solution's may be a copy of it.
    """
    withdraw(state)
    other = state.copy()
    begun = [_begun(state)]
    if reunite(other):
        begun.append(_begun(other))
    problem, solved = min(begun, key=lambda one: _misfit(*one))
    state, rows = problem.layout.state, problem.rows
    first, *later = LEARNING
    learn(state, problem, solved, first, kinds=False)
    for most in later:
        problem = Problem(_layout(state), rows, None)
        solved = problem.solve(solved.x, iterations=1)
        learn(state, problem, solved, most, kinds=False)
    problem = _problem(state)
    problem, solved = _settled(problem, problem.solve(solved.x), RESTING)
    # Last, for a node that was moved makes ranges differ like a wall.
    problem.rows.obstruct(solved.x)
    return problem, problem.solve(solved.x) if problem.rows.shift.any() else solved


def _begun(state: FusionState) -> tuple[Problem, Solved]:
    """A solution that is at rest enough to be learned from, with all nodes that were moved where they lie."""
    problem = _problem(state)
    solved = problem.solve(problem.layout.start(), SLACKS_M, resting=LEARNING_RESTING)
    return _settled(problem, solved, LEARNING_RESTING)


def _misfit(problem: Problem, solved: Solved) -> float:
    """How much worse a solution is than one that fits all its readings, in log likelihood.

    Each place that it needs is to be worth what it is worth to find one.
    """
    rows = problem.rows
    at_best = mixture_cost(np.zeros(len(rows.sigma)), rows.sigma, *rows.noise.T)
    return float(solved.cost - at_best.sum() + GAIN * len(problem.layout.stands))


def _settled(problem: Problem, solved: Solved, resting: float) -> tuple[Problem, Solved]:
    """The solution with all nodes that were moved where they lie: they begin anew in its state.

    Args:
        problem: of the whole incident.
        solved: its solution with them where they were thought to be.
        resting: see `Problem.solve`.
    """
    for _ in range(MOVES):
        moves, _ = moved_nodes(problem, solved, math.inf)
        if not moves:
            break
        _begin_elsewhere(problem, solved, moves)
        problem = _problem(problem.layout.state)
        solved = problem.solve(problem.layout.start(), SLACKS_M, resting=resting)
    return problem, solved


def _problem(state: FusionState) -> Problem:
    layout = _layout(state)
    rows = Rows(layout, -math.inf)
    rows.learn(state.noise)
    return Problem(layout, rows, None)


def _layout(state: FusionState) -> Layout:
    begins = state.ledger.table("begins")
    since_t = float(begins[:, 0].min()) if len(begins) else state.newest_t
    return Layout(state, since_t, spacing_s(state, since_t, state.newest_t))


def _begin_elsewhere(problem: Problem, solved: Solved, moves: Sequence[Moved]) -> None:
    """Nodes that were moved begin anew, beside the others as they are in the solution."""
    layout, state = problem.layout, problem.layout.state
    settle(state, layout, solved, solved.chain.remainder(layout.length - 1).matrix)
    keep_keyframes(state, layout, solved.x)
    for moved in moves:
        branch(state, moved)
    decide(state, math.inf)


def spacing_s(state: FusionState, since_t: float, until_t: float) -> float:
    """How far apart keyframes stand (s): as near as the whole chain allows."""
    width = 6 * len({row[1] for row in state.ledger.table("begins")})
    border = 3 * len(state.ledger.table("stands")) + 8
    spacing = usual_s(state)
    while (until_t - since_t) / spacing * width * (
        border + 2 * width
    ) > LARGEST and until_t - since_t > spacing:
        spacing *= 2.0
    return spacing


def online_pass(readings: Sequence[AnyFolded], settings: TrackerSettings) -> FusionState:
    """Fold the readings once, in ticks of `TICK_S`.

    Args:
        readings: in canonical order.
        settings: of the incident.
    """
    state = FusionState(settings.origin_wgs84)
    state.ledger = Ledger(complete=True)
    start = 0
    while start < len(readings):
        until_t = (math.floor(readings[start].until_t / TICK_S) + 1) * TICK_S
        end = bisect_left(readings, until_t, start, key=UNTIL_T)
        fold_tick(state, until_t, readings[start:end])
        keep_up(state, until_t, RARER)
        start = end
    flush(state)
    look_again(state)
    keep_poses(state)
    return state


def lifetimes(readings: Sequence[AnyFolded]) -> dict[str, tuple[float, float]]:
    """First and last epoch of each node's readings, which come in order of epoch."""
    first: dict[str, float] = {}
    last: dict[str, float] = {}
    for reading in readings:
        since_t, until_t = reading.t, reading.until_t
        for name in names_of(reading):
            last[name] = until_t
            if name not in first or since_t < first[name]:
                first[name] = since_t
    return {name: (t, last[name]) for name, t in first.items()}
