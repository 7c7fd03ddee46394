"""The window solved: recent keyframes linearised again at what is known now, before they are marginalised.

Of several hypotheses, and of the images of ways, the likeliest solution counts. The filter goes on from it.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.memory.prior import Prior
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.unreliable_unit import may_have_turned
from estimator.graph.robust import GOOD
from estimator.smoothing.back_to_filter import hand_back, keep_keyframes
from estimator.smoothing.images.alternatives import Mode, alternatives_now
from estimator.smoothing.images.flip_ambiguity import LIVE, Effort
from estimator.smoothing.images.likeliest_image import JudgedImages, likeliest_image
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.levelled_ways import forget_steps, tell_rises
from estimator.smoothing.problem.gauge_turn import turned
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.readings.rows import Rows
from estimator.smoothing.readings.sharing import LINK
from estimator.smoothing.units.carried_bearers import carried_bearers
from estimator.smoothing.units.turned_frames import turned_frames
from estimator.smoothing.units.unit_mounting import likeliest_mounting
from estimator.smoothing.units.unseen_climbs import find_unseen_climb, hinted
from estimator.smoothing.window_extent import LONGEST_S, STEPS_S, restart, spacing_s, trim
from estimator.smoothing.window_findings import tell_findings
from estimator.smoothing.window_starts import ITERATIONS, RESTING, solved_from

GONE = 8.0
"""A window this many times as long as it may be is begun anew."""


def refresh(state: FusionState, solved_t: float, bent: bool = False, effort: Effort = LIVE) -> bool:
    """Solve the window again, and go on from its solution.

    Args:
        state: the fusion, changed in place.
        solved_t: when it was last solved (s).
        bent: something has just been told that may have bent it all.
        effort: how much is asked of images.

    Returns:
        False where it has none: the filter goes on as it was.
    """
    since = state.window_t = _since(state)
    if state.newest_t - since > GONE * LONGEST_S:
        restart(state)
        return False
    try:
        judged, mountings = _likeliest(state, since, solved_t, bent, effort)
        state.exposed = judged.exposed
        clear = _past_walls(state, judged)
        trimmed = trim(clear.problem, clear.solved)
        _hand_back(state, clear, mountings)
        causes = tell_findings(state, judged, solved_t, partial(_problem, since=since))
    except ValueError as error:
        text = f"the last minutes could not be solved again, positions go on without: {error}"
        state.say("unsolved", state.newest_t, None, text)
        return False
    _remember(state, clear, trimmed)
    # Where one is likely to be wrong, look again soon which one.
    state.suspected = state.suspected or causes.wrong or any(map(may_have_turned, state.nodes.values()))
    causes.correct(state)
    return True


def _since(state: FusionState) -> float:
    """Where the window begins (s): with the first node, until its oldest keyframes are marginalised."""
    if state.window_t is not None:
        return state.window_t
    beginnings = state.ledger.table("begins"), state.ledger.table("stands")
    return float(min(rows[:, 0].min() for rows in beginnings if len(rows)))


def _likeliest(
    state: FusionState, since: float, solved_t: float, bent: bool, effort: Effort
) -> tuple[JudgedImages, list[Mode]]:
    """The likeliest solution of all hypotheses, and others by how units are worn."""
    build = partial(_problem, since=since)
    problem = build(state)
    solved = solved_from(problem, problem.layout.start(), solved_t, bent)
    if hinted(problem, solved):
        problem, solved = find_unseen_climb(problem, solved, build, RESTING)
    problem, solved = carried_bearers(problem, solved, build, RESTING)
    problem, solved = turned_frames(problem, solved, build, RESTING)
    problem, solved, mountings = likeliest_mounting(problem, solved, build, RESTING, solved_t)
    return likeliest_image(problem, solved, effort), mountings


def _problem(state: FusionState, since: float) -> Problem:
    layout = Layout(state, since, spacing_s(state), state.prior)
    rows = Rows(layout, since)
    rows.learn(state.noise)
    return Problem(layout, rows, state.prior)


def _past_walls(state: FusionState, judged: JudgedImages) -> JudgedImages:
    """The solution with what walls add to ranges taken off, and what crews lose to anchors asked.

    The filter takes what walls add off each link's next ranges.

    All else is asked of the window without that, and its outliers are left what they are: the first ranges to
    a breadcrumb that was kicked scatter as well, and taken for a wall's they would lead who passes astray.
    """
    solved = judged.solved
    rows, walls = judged.problem.rows.obstructed(solved.x, solved.weighted.good > GOOD)
    # No more than may always be between two radios is no wall.
    is_clear = walls.mean_m.max(initial=0.0) < physics.WALL_M
    told = [np.zeros_like(one) if is_clear else one for one in walls]
    state.links.tell_walls(rows.pairs[:, LINK].astype(np.intp), *told)
    if is_clear and not judged.problem.layout.ranges_lose:
        return judged
    problem = (judged.problem if is_clear else judged.problem.with_rows(rows)).with_losses()
    return judged._replace(problem=problem, solved=problem.solve(solved.x, (), ITERATIONS, RESTING))


def _hand_back(state: FusionState, judged: JudgedImages, mountings: Sequence[Mode]) -> None:
    """Let the filter go on from the solution, and each node know where else it may be."""
    problem, x = judged.problem, judged.solved.x
    layout = problem.layout
    left = judged.solved.remainder(layout.length - 1)
    left = turned(left, layout, problem.pivot_m, problem.first(x), x)
    hand_back(state, layout, judged.solved, left.matrix)
    tell_rises(state, [walk.number for walk in layout.walks if walk.way is not None])
    for name, images in alternatives_now(layout, x, [*judged.modes, *mountings]).items():
        state.nodes[name] = replace(state.nodes[name], otherwise=images)


def _remember(state: FusionState, judged: JudgedImages, trimmed: tuple[Prior, float] | None) -> None:
    """Keep where everyone was; of what leaves the window, where it has become long, only a prior."""
    layout, x = judged.problem.layout, judged.solved.x
    keep_keyframes(state, layout, x)
    border = x[layout.length * layout.width :]
    state.lost = {number: float(border[one.column]) for (_, number), one in layout.lost.items()}
    state.prior = judged.problem.prior
    if trimmed is not None:
        state.prior, state.window_t = trimmed
        state.ledger.forget(state.window_t, ("pairs", "singles", "drops", "poses"))
        forget_steps(state, state.window_t - STEPS_S)
