"""What has left the window, in the next one: as it was said, wherever the map has turned to meanwhile."""

from typing import NamedTuple

import numpy as np
import pytest

from estimator.fusion.memory.prior import SIZES, Prior
from estimator.graph.dense import Array
from estimator.measurements.retire import Retire
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.chain.groups import Groups
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.gauge_turn import STEADY_M
from estimator.smoothing.problem.marginal_prior import MarginalPrior
from estimator.smoothing.problem.newton import Problem
from tests.estimator.smoothing.map_rotation import HEADING_SIGMA_RAD, turned_map, walk_past_beacons
from tests.estimator.smoothing.problem.test_marginals import prior_at, window_from
from tests.estimator.smoothing.windows import difference, fused, problem_of

BASE_M = (37.0, -22.0)


class Later(NamedTuple):
    """A window that goes on from the middle of a longer one, which has come to rest: prior and solution."""

    layout: Layout
    prior: Prior
    x: Array


def cut_in_the_middle(whole: Problem) -> Later:
    """The second half of a window, with what the first half has left as its prior."""
    solved = whole.solve(whole.layout.start())
    cut = whole.layout.length // 2
    window = window_from(whole, solved, cut)
    return Later(window.layout, prior_at(whole, solved, cut), solved.x[cut * window.layout.width :])


@pytest.mark.parametrize("by_rad", [-0.4, 0.05, 1.0])
def test_a_map_turned_as_a_whole_fits_as_it_did_but_for_what_was_said_of_headings(by_rad: float) -> None:
    layout, prior, x = LATER
    assert [walk.way is None for walk in layout.walks] == [False, True]
    assert layout.state.nodes["base"].mode == "retired"
    carried, size = MarginalPrior(layout, prior), layout.length * layout.width
    there, way = turned_map(layout, x, by_rad)
    n = np.concatenate([way[: layout.width], way[size:]])[: len(prior.vector)]
    known, pull = float(n @ prior.matrix @ n), float(n @ prior.vector)
    expected = 0.5 * known * by_rad**2 - pull * by_rad
    assert known < 1.1 / HEADING_SIGMA_RAD**2
    assert carried.cost(there) - carried.cost(x) == pytest.approx(expected, rel=0.02, abs=0.02)
    first = carried.first(there)
    for start in layout.stands.values():
        own = slice(size + start, size + start + 2)
        share = STEADY_M / float(np.hypot(*(there[own] - BASE_M)))
        assert np.hypot(*(first[own] - there[own])) < share * abs(by_rad) * STEADY_M

    def cost(at: Array) -> Array:
        return np.array([carried.cost(at)])

    groups = Groups(layout.width, layout.border, [carried.coupled]).each
    chain = Chain(layout.length, layout.width, groups)
    carried.add(chain, carried.shared(groups), there)
    slope = -difference(cost, there)[0]
    assert np.abs(chain.slope() - slope).max() < 0.02 * np.abs(slope).max() + 1e-3


class Hardly(NamedTuple):
    """A prior that hardly knows a beacon: its numbers among those of the prior, and among all unknowns."""

    prior: Prior
    at: slice
    own: slice


def hardly_knowing(layout: Layout, prior: Prior) -> Hardly:
    """The same prior without what it knows of the first beacon of its window."""
    number, start = next(iter(layout.stands.items()))
    first = sum(SIZES[kind] for kind, _ in prior.keys[: prior.keys.index(("stand", number))])
    at, matrix, vector = slice(first, first + 3), prior.matrix.copy(), prior.vector.copy()
    matrix[at] = matrix[:, at] = vector[at] = 0.0
    matrix[at, at] = 1e-6 * np.eye(3)
    border = layout.length * layout.width + start
    return Hardly(prior._replace(matrix=matrix, vector=vector), at, slice(border, border + 3))


def test_a_place_that_the_prior_hardly_knows_is_looked_at_where_it_is() -> None:
    layout, prior, x = LATER
    hardly, at, own = hardly_knowing(layout, prior)
    there = x.copy()
    there[own] += np.array([4.0, -3.0, 0.0])
    known = MarginalPrior(layout, prior).first(there)
    assert np.hypot(*(known[own] - prior.reference[at])[:2]) < 1.0
    unknown = MarginalPrior(layout, hardly).first(there)
    assert (unknown[own] == there[own]).all()
    others = np.setdiff1d(np.arange(layout.length * layout.width, len(x)), np.arange(own.start, own.stop))
    assert np.abs(unknown[others] - x[others]).max() < 0.1


def test_every_height_is_looked_at_where_it_is() -> None:
    layout, prior, x = LATER
    places = layout.length * layout.width + np.array(list(layout.stands.values()))
    there = x.copy()
    there[places + 2] += 4.0
    carried = MarginalPrior(layout, prior)
    assert np.array_equal(carried.first(there)[places + 2], there[places + 2])
    assert np.array_equal(carried.first(there)[places], carried.first(x)[places])


def test_a_window_rests_whatever_height_a_place_was_thought_to_have_that_is_known_but_for_that() -> None:
    layout, prior, x = LATER
    hardly, at, own = hardly_knowing(layout, prior)
    hardly.matrix[at, at][:2, :2] = np.eye(2) / 0.3**2
    level, reference = hardly.reference.copy(), hardly.reference.copy()
    level[at] = x[own]
    reference[at] = x[own] + np.array([0.0, 0.0, 20.0])
    found, other = (
        problem_of(layout.state, float(layout.grid[0]), hardly._replace(reference=was)).solve(x)
        for was in (level, reference)
    )
    assert found.rests
    assert other.rests
    assert np.abs(other.x[own] - found.x[own]).max() < 0.05


def test_a_window_rests_wherever_a_place_was_thought_to_be_of_which_nothing_was_known() -> None:
    layout, prior, x = LATER
    hardly, at, own = hardly_knowing(layout, prior)
    elsewhere = hardly.reference.copy()
    elsewhere[at] += np.array([-14.0, 25.0, 0.0])
    found, other = (
        problem_of(layout.state, float(layout.grid[0]), hardly._replace(reference=reference)).solve(x)
        for reference in (hardly.reference, elsewhere)
    )
    assert found.rests
    assert other.rests
    assert np.abs(other.x[own] - found.x[own]).max() < 0.05
    assert np.abs(other.x - found.x).max() < 0.2


def test_what_is_known_of_who_has_gone_does_not_hold_the_map() -> None:
    layout, prior, x = LATER
    chance = np.random.default_rng(2)
    size, m = len(prior.vector), STATES
    # Someone whom the second half knows no more was tied to the first walker's place.
    beside = np.zeros((m, size + m))
    beside[:, :m] = chance.normal(0.0, 1.0, (m, m))
    beside[:, size:] = -beside[:, :m]
    matrix = np.zeros((size + m, size + m))
    matrix[:size, :size] = prior.matrix
    matrix += beside.T @ beside
    vector = np.concatenate([prior.vector, np.zeros(m)])
    reference = np.concatenate([prior.reference, np.ones(m)])
    gone = Prior((*prior.keys, ("walk", 999)), matrix, vector, reference, prior.epochs)
    there, _ = turned_map(layout, x, 0.3)
    alone, among = MarginalPrior(layout, prior), MarginalPrior(layout, gone)
    assert among.cost(there) - among.cost(x) == pytest.approx(alone.cost(there) - alone.cost(x), abs=1e-6)


def test_what_is_tied_in_one_direction_only_is_tied_in_both_once_the_map_has_turned() -> None:
    layout, prior, _ = LATER
    matrix = np.diag(np.diag(prior.matrix))
    matrix[0, -4] = matrix[-4, 0] = 0.1  # the first walker's east and the last beacon's north
    tied = MarginalPrior(layout, prior._replace(matrix=matrix)).coupled
    first = {int(b) for a, b in tied if a == 1}
    assert {0, 1} < first


WALK = [*walk_past_beacons(BASE_M, free=True), Retire(t=60.5, node="base", reason="switched off")]
LATER = cut_in_the_middle(problem_of(fused(WALK)))
