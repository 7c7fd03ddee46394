"""What is eliminated leaves what it knew behind: marginals of chains and of windows against the whole."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.memory.prior import SIZES, Key, Prior
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.chain.groups import Groups
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.random_chains import SHAPES, Shape, alone, groups_of, random_chain
from tests.estimator.smoothing.windows import at_rest, dense, fused, problem_of
from tests.estimator.walks import two_responders

NO_OUTLIERS = 1e-200


def assert_alike(found: NDArray[Any], expected: NDArray[Any], tolerance: float) -> None:
    assert found.shape == expected.shape
    assert np.abs(found - expected).max(initial=0.0) <= tolerance * np.abs(expected).max(initial=1e-300)


@pytest.mark.parametrize("shape", SHAPES)
def test_solving_what_a_remainder_leaves_equals_solving_whole(shape: Shape) -> None:
    whole, gradient = dense(random_chain(shape))
    expected = np.linalg.solve(whole, gradient)
    for keyframe in sorted({0, 1, shape.length // 2, shape.length - 1}):
        chain = random_chain(shape)
        left = chain.remainder(keyframe)
        rest, width = Chain(shape.length - keyframe, shape.width, groups_of(shape)), chain.width
        for strand, before in zip(rest.strands, chain.strands, strict=True):
            own, lasting = strand.group.columns, width + strand.group.lasting
            strand.diagonal[:], strand.link[:] = before.diagonal[keyframe:], before.link[keyframe:]
            strand.wide[:] = before.wide[keyframe:]
            strand.diagonal[0], strand.border[0] = (
                left.matrix[np.ix_(own, own)],
                left.matrix[np.ix_(own, lasting)],
            )
            strand.gradient[0] = left.vector[own]
        rest.strands[-1].corner[:] = left.matrix[width:, width:]
        rest.strands[-1].corner_gradient[:] = left.vector[width:]
        assert_alike(np.concatenate([a.ravel() for a in rest.solve()]), expected[keyframe * width :], 1e-9)
        on = np.concatenate([a.ravel() for a in chain.solve()])
        assert_alike(on, expected, 1e-9)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_remainder_at_the_end_is_the_marginal_of_the_newest_keyframe_and_the_border(shape: Shape) -> None:
    whole, gradient = dense(random_chain(shape))
    chain = random_chain(shape)
    kept = slice((shape.length - 1) * chain.width, None)
    left = chain.remainder(shape.length - 1)
    assert_alike(np.linalg.inv(left.matrix), np.linalg.inv(whole)[kept, kept], 1e-9)
    assert_alike(np.linalg.solve(left.matrix, left.vector), np.linalg.solve(whole, gradient)[kept], 1e-9)


@pytest.mark.parametrize("shape", [*SHAPES, alone(1, 3, 2), alone(1, 4, 0)])
def test_covariances_and_responses_are_blocks_of_the_dense_inverse(shape: Shape) -> None:
    chain = random_chain(shape)
    inverse, width = np.linalg.inv(dense(chain)[0]), chain.width
    chain.solve()
    walks, ahead, border = chain.covariances()
    for j, i in np.ndindex(shape.length, width // shape.size):
        own = slice(j * width + i * shape.size, j * width + (i + 1) * shape.size)
        assert_alike(walks[j, i], inverse[own, own], 1e-9)
        if j + 1 < shape.length:
            assert_alike(ahead[j, i], inverse[own, own.start + width : own.stop + width], 1e-9)
    size = shape.length * width
    assert_alike(border, inverse[size:, size:], 1e-9)
    put = np.random.default_rng(0).normal(0.0, 1.0, (len(inverse), 2))
    moved, fixed = chain.response(put[:size].reshape(shape.length, width, 2), put[size:])
    assert_alike(np.concatenate([moved.reshape(size, 2), fixed]), inverse @ put, 1e-9)
    taken = chain.explained(put[:size].reshape(shape.length, width, 2), put[size:])
    assert_alike(taken.information, put.T @ inverse @ put, 1e-9)


def test_groups_are_what_direct_readings_couple() -> None:
    """Walks 0 and 2 measure to each other, and to the first column of the border; 1 to the second."""
    rows = np.full((4, 12), -1)
    rows[0, [0, 6]] = 2, 14
    rows[1, [0, 6]] = 13, 18
    rows[2, [0, 6]] = 7, 19
    rows[3, 0] = 20
    groups = Groups(18, 3, [rows])
    found = [(g.walks.tolist(), g.lasting.tolist()) for g in groups.each]
    assert found == [([0, 2], [0]), ([1], [1]), ([], [0, 1, 2])]
    placed = groups.placed(np.zeros(4, dtype=np.int64), rows)
    assert placed.columns[:, [0, 6]].tolist() == [[2, 8], [7, 12], [1, 6], [2, -1]]
    assert [part.tolist() for part in placed.parts] == [[0, 1], [2], [3]]


def prior_at(problem: Problem, solved: Solution, cut: int) -> Prior:
    """What the keyframes before one say of it and of the border."""
    layout = problem.layout
    chain = problem.assemble(solved.x, solved.linear, solved.weighted, solved.motions, cut)
    left = chain.remainder(cut)
    keys: list[Key] = []
    at: list[int] = []
    epochs: dict[int, float] = {}
    for i, walk in enumerate(layout.walks):
        if walk.first <= cut <= walk.last:
            keys.append(("free" if walk.way is None else "walk", walk.number))
            epochs[walk.number] = float(layout.times[cut, i])
            at += range(STATES * i, STATES * (i + 1))
    for number, start in layout.stands.items():
        keys.append(("stand", number))
        at += range(layout.width + start, layout.width + start + 3)
    for key, start in layout.technologies.items():
        keys.append(key)
        at += range(layout.width + start, layout.width + start + SIZES[key[0]])
    for key, loss in layout.lost.items():
        keys.append(key)
        at.append(layout.width + loss.column)
    reference = from_cut(problem, solved.x, cut)[np.r_[: layout.width, -layout.border : 0]][at]
    return Prior(tuple(keys), left.matrix[np.ix_(at, at)], left.vector[at], reference, epochs)


def from_cut(problem: Problem, x: Array, cut: int) -> Array:
    """The estimate without the keyframes before one."""
    return x[cut * problem.layout.width :]


def assert_same_from_cut(whole: Problem, at: Solution, cut: int, window: Problem, again: Solution) -> None:
    """Estimates and covariances after the cut, of both Problems and one more step of theirs, are the same."""
    assert window.layout.grid == pytest.approx(whole.layout.grid[cut:])
    steps, fixed = at.chain.solve()
    expected = from_cut(whole, at.x + np.concatenate([steps.ravel(), fixed]), cut)
    steps, fixed = again.chain.solve()
    reached = again.x + np.concatenate([steps.ravel(), fixed])
    found, right = again.chain.covariances(), at.chain.covariances()
    sigma = np.sqrt(np.diagonal(right[0], axis1=2, axis2=3)[cut:])
    lasting = np.sqrt(np.diagonal(right[2]))
    assert np.abs((reached - expected) / np.concatenate([sigma.ravel(), lasting])).max() < 1e-6
    assert np.abs((found[0] - right[0][cut:]) / sigma[..., None] / sigma[..., None, :]).max() < 1e-6
    assert np.abs((found[1] - right[1][cut:]) / sigma[:-1, ..., None] / sigma[1:, ..., None, :]).max() < 1e-6
    assert np.abs((found[2] - right[2]) / lasting[:, None] / lasting).max(initial=0.0) < 1e-6


def window_from(whole: Problem, at: Solution, cut: int) -> Problem:
    """The window from a keyframe on, with what the keyframes before it leave."""
    return problem_of(whole.layout.state, float(whole.layout.grid[cut]), prior_at(whole, at, cut))


def fixes(node: str, seconds: int, sigma_m: float, seed: int) -> list[AnyReading]:
    """A fix each second, of somebody who walks round a circle."""
    chance = np.random.default_rng(seed)
    found: list[AnyReading] = []
    for second in range(seconds + 1):
        turn = second / 12.0
        there = 12.0 * np.array([np.sin(turn), 1.0 - np.cos(turn), 0.0])
        e, n, u = (there + chance.normal(0.0, sigma_m, 3)).tolist()
        found.append(Position(t=float(second), node=node, position_m=(e, n, u), sigma_m=(sigma_m,) * 3))
    return found


@pytest.mark.parametrize("cut", [1, 17, 50])
def test_a_linear_window_after_its_prior_says_what_the_whole_incident_says(cut: int) -> None:
    """Two responders without PDR and fixes only: everything is linear, and the start does not matter."""
    whole = problem_of(fused([*fixes("ff1", 60, 0.5, 1), *fixes("ff2", 60, 2.0, 2)]))
    assert whole.layout.width == 2 * STATES
    whole.rows.noise[:, 0] = NO_OUTLIERS
    elsewhere = np.random.default_rng(cut).normal(0.0, 10.0, len(whole.layout.start()))
    at = at_rest(whole, elsewhere)
    window = window_from(whole, at, cut)
    window.rows.noise[:, 0] = NO_OUTLIERS
    again = at_rest(window, from_cut(whole, elsewhere, cut))
    assert_same_from_cut(whole, at, cut, window, again)


@pytest.mark.parametrize("cut", [1, 9, 25])
def test_the_same_for_a_unit_whose_heading_is_known(cut: int) -> None:
    walk: list[AnyReading] = [Node(t=0.0, node="ff1", role="responder", heading_sigma_rad=0.001)]
    walk += fixes("ff1", 60, 0.5, 3)
    for second in range(1, 61):
        e, n = np.cos((second - 0.5) / 12.0), np.sin((second - 0.5) / 12.0)
        walk.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(e, n, 0.0)))
    whole = problem_of(fused(walk))
    at = at_rest(whole, whole.layout.start())
    window = window_from(whole, at, cut)
    again = at_rest(window, window.layout.start())
    assert_same_from_cut(whole, at, cut, window, again)


@pytest.mark.parametrize("cut", [1, 5, 30, 58])
def test_among_beacons_ranges_and_breadcrumbs_a_window_takes_the_step_of_the_whole_incident(
    cut: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Readings of all kinds, outliers included, linearised at the same estimate.

    Altimeters that stay as they are: from window to window they may drift, in a whole incident they do not.
    """
    monkeypatch.setattr(physics, "HEIGHT_WALK_M_PER_ROOT_S", 0.0)
    whole = problem_of(fused(two_responders(60)))
    at = whole.solve(whole.solve(whole.layout.start()).x, iterations=0)
    window = window_from(whole, at, cut)
    again = window.solve(from_cut(whole, at.x, cut), iterations=0)
    assert_same_from_cut(whole, at, cut, window, again)


def test_a_unit_that_was_silent_when_the_window_was_cut_goes_on_from_where_it_was_last_heard() -> None:
    """Its next displacement begins there, before the cut: none of it may be lost, nor counted twice."""
    heard = [Node(t=0.0, node="ff1", role="responder", heading_sigma_rad=0.001), *fixes("ff1", 20, 0.5, 1)]
    for second in range(1, 21):
        e, n = np.cos((second - 0.5) / 12.0), np.sin((second - 0.5) / 12.0)
        heard.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(e, n, 0.0)))
    others = fixes("ff2", 60, 0.5, 2)
    then = problem_of(fused([*heard, *others[:40]]))
    cut = int(np.searchsorted(then.layout.grid, 30.0))
    prior = prior_at(then, at_rest(then, then.layout.start()), cut)
    walked = Displacement(t=45.0, from_t=20.0, node="ff1", delta_m=(20.0, 5.0, 0.0))
    now = fused([*heard, *others, walked])
    whole, window = problem_of(now), problem_of(now, float(then.layout.grid[cut]), prior)
    places = []
    for problem in (whole, window):
        x = at_rest(problem, problem.layout.start()).x
        last = (problem.layout.length - 1) * problem.layout.width
        column = last + problem.layout.column_of[now.nodes["ff1"].index]
        places.append(x[column : column + 3])
    assert places[1] == pytest.approx(places[0], abs=0.05)


def test_from_window_to_window_an_altimeter_drifts_and_nothing_else_is_forgotten() -> None:
    whole = problem_of(fused(two_responders(60)))
    at = whole.solve(whole.solve(whole.layout.start()).x, iterations=0)
    window = window_from(whole, at, 30)
    again = window.solve(from_cut(whole, at.x, 30), iterations=0)
    again.chain.solve()
    at.chain.solve()
    border, before = again.chain.covariances()[2], at.chain.covariances()[2]
    found = {kind for kind, _ in whole.layout.technologies}
    assert "altimeter" in found
    for (kind, _), start in whole.layout.technologies.items():
        grown = border[start, start] / before[start, start]
        assert grown > 1.0001 if kind == "altimeter" else grown == pytest.approx(1.0, abs=1e-3)
