"""The derivatives of ways, ends and rows of a window against finite differences, at random states."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.memory.ledger import BODY_BEARING, RANGE, RSSI
from estimator.graph import parallel
from estimator.graph.dense import Array
from estimator.measurements import bearing
from estimator.smoothing.keyframes.displacement_sums import Way
from estimator.smoothing.keyframes.ends import place_ends
from estimator.smoothing.keyframes.ground import ends_of, ground_of
from estimator.smoothing.keyframes.walks import STATES, Motion, dead_reckon, free_motions, unit_motion
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.readings.rows import Rows
from tests.estimator.smoothing.windows import difference, in_the_open, random_state

seeds = st.integers(0, 10_000)


def steps_of(seed: int, count: int = 40) -> Array:
    """Rows of the ledger's `steps`, of a unit that walks about, with pauses and a lift."""
    chance = np.random.default_rng(seed)
    rows = np.zeros((count, 12))
    rows[:, 0] = np.cumsum(chance.uniform(0.4, 1.5, count))
    rows[:, 2] = np.r_[0.0, rows[:-1, 0]]
    rows[:, 3:6] = chance.normal(0.0, 1.0, (count, 3)) * chance.choice([0.0, 1.0], (count, 1), p=[0.2, 0.8])
    rows[:, 6:11] = chance.uniform(1e-6, 1e-3, (count, 5))
    return rows


def unit_states(chance: np.random.Generator, count: int) -> Array:
    """Any position and heading; a bias and a scale such as units have."""
    states = np.zeros((count, STATES))
    states[:, :3] = chance.normal(0.0, 30.0, (count, 3))
    states[:, 3] = chance.uniform(-np.pi, np.pi, count)
    states[:, 4], states[:, 5] = chance.normal(0.0, 0.01, count), chance.normal(0.0, 0.05, count)
    return states


@given(seeds)
def test_where_a_unit_is_led_to_changes_with_its_states_as_told(seed: int) -> None:
    chance = np.random.default_rng(seed)
    way = Way(0.0, steps_of(seed), (1.0, 1.0))
    since, until = np.sort(chance.uniform(0.0, 40.0, (2, 5)), axis=0)
    between, before = way.between(since, until), unit_states(chance, 5)
    _, transition = dead_reckon(before, between[:, :3], between[:, 3:6], until - since)
    for k in range(5):
        own = slice(k, k + 1)

        def led(x: Array, own: slice = own) -> Array:
            delta, moment = between[own, :3], between[own, 3:6]
            there, _ = dead_reckon(x[None], delta, moment, (until - since)[own])
            return np.asarray(there[0])

        assert np.abs(transition[k] - difference(led, before[k])).max() < 1e-6


@given(seeds)
def test_the_residuals_of_motions_change_with_both_their_ends(seed: int) -> None:
    """The next keyframe's residual has derivative 1 by itself and −F by the one before, on the way itself."""
    chance = np.random.default_rng(seed)
    way, times = Way(0.0, steps_of(seed), (1.0, 1.0)), np.sort(chance.uniform(0.0, 40.0, 5))
    durations = np.diff(times)
    between = way.between(times[:-1], times[1:])
    states = unit_states(chance, 5)
    kinds: list[Callable[[Array], Motion]] = [
        lambda x: unit_motion(between, durations, x),
        lambda x: free_motions("responder", durations).motion(x),
    ]
    for motion_of in kinds:
        # To where the motion leads: elsewhere a unit's heading, and the scale of its noise, have a part in F.
        for k in range(4):
            states[k + 1] -= motion_of(states).residual[k]
        motion = motion_of(states)
        assert np.abs(motion.residual).max() < 1e-9

        def residual(x: Array, motion_of: Callable[[Array], Motion] = motion_of) -> Array:
            return motion_of(x.reshape(5, STATES)).residual.ravel()

        expected = np.zeros((4 * STATES, 5 * STATES))
        for k in range(4):
            own = slice(k * STATES, (k + 1) * STATES)
            expected[own, own] = -motion.transition[k]
            expected[own, (k + 1) * STATES : (k + 2) * STATES] = np.eye(STATES)
        assert np.abs(difference(residual, states.ravel()) - expected).max() < 1e-5


@given(seeds)
def test_a_way_is_the_sum_of_its_parts(seed: int) -> None:
    chance = np.random.default_rng(seed)
    way = Way(0.0, steps_of(seed), (2.0, 0.5))
    first, middle, last = np.sort(chance.uniform(0.0, 70.0, (3, 8)), axis=0)
    one, other, both = way.between(first, middle), way.between(middle, last), way.between(first, last)
    total = one + other
    total[:, 3:6] += other[:, :3] * (middle - first)[:, None]
    assert both == pytest.approx(total, abs=1e-9)


@given(seeds)
def test_two_steps_of_a_unit_lead_where_one_does(seed: int) -> None:
    """However the way turns in between: exact up to the second order of β Δt."""
    chance = np.random.default_rng(seed)
    way, before = Way(0.0, steps_of(seed, 10), (1.0, 1.0)), unit_states(chance, 1)
    before[:, 4] = 1e-4
    marks = np.sort(chance.uniform(0.0, 8.0, 3))
    there = before
    for a, b in ((marks[0], marks[1]), (marks[1], marks[2])):
        part = way.between(np.array([a]), np.array([b]))
        there, _ = dead_reckon(there, part[:, :3], part[:, 3:6], np.array([b - a]))
    whole = way.between(marks[:1], marks[2:])
    once, _ = dead_reckon(before, whole[:, :3], whole[:, 3:6], marks[2:] - marks[:1])
    assert np.abs(once - there).max() < 10.0 * 10.0 * (1e-4 * 8.0) ** 2


def test_a_heading_that_walks_randomly_moves_the_end_of_a_straight_way_as_told() -> None:
    chance, parts, trials = np.random.default_rng(1), 200, 20_000
    length, variance = 30.0, 0.1**2
    headings = np.cumsum(chance.normal(0.0, np.sqrt(variance / parts), (trials, parts)), axis=1)
    sideways = headings.mean(axis=1) * length
    seen = np.cov(np.stack([sideways, headings[:, -1]]))
    between = np.zeros((1, 12))
    between[0, 0], between[0, 8] = length, variance
    noise = unit_motion(between, np.array([30.0]), np.zeros((2, STATES))).noise[0]
    assert seen == pytest.approx(noise[np.ix_([1, 3], [1, 3])], rel=0.05)


def test_the_information_of_a_step_is_the_inverse_of_its_noise() -> None:
    chance, k = np.random.default_rng(3), 50
    between = np.concatenate([chance.normal(0.0, 30.0, (k, 6)), 10.0 ** chance.uniform(-9.0, 1.0, (k, 6))], 1)
    states = chance.normal(0.0, 10.0, (k + 1, STATES)) * np.array([1.0, 1.0, 1.0, 1.0, 1e-4, 1e-2])
    motion = unit_motion(between, np.full(k, 4.0), states)
    scale = np.sqrt(np.diagonal(motion.noise, axis1=1, axis2=2))
    whole = motion.information @ motion.noise / scale[:, None, :] * scale[:, :, None]
    assert whole == pytest.approx(np.broadcast_to(np.eye(STATES), whole.shape), abs=1e-6)


def test_the_motion_of_a_node_without_pdr_is_the_same_in_one_step_and_in_two() -> None:
    one = free_motions("responder", np.array([5.0]))
    two = free_motions("responder", np.array([2.0, 3.0]))
    assert two.transition[1] @ two.transition[0] == pytest.approx(one.transition[0])
    carried = two.transition[1] @ two.noise[0] @ two.transition[1].T + two.noise[1]
    assert carried == pytest.approx(one.noise[0], abs=1e-5)


def spread(rows: Rows, jacobian: Array, problem: Problem) -> Array:
    """Jacobians by the columns of each row as one by the flat unknowns."""
    found = np.zeros((len(rows.slab), problem.layout.length * problem.layout.width + problem.layout.border))
    for row in range(len(found)):
        found[row] = spread_row(rows, row, jacobian[row], problem)
    return found


def spread_row(rows: Rows, row: int, slopes: Array, problem: Problem) -> Array:
    """Derivatives by the columns of one row as those by the flat unknowns."""
    layout = problem.layout
    size = layout.length * layout.width
    found = np.zeros(size + layout.border)
    for column, value in zip(rows.columns[row].tolist(), slopes.tolist(), strict=True):
        if column >= layout.width:
            found[size + column - layout.width] += value
        elif column >= 0:
            found[rows.slab[row] * layout.width + column] += value
        else:
            assert value == 0.0
    return found


@pytest.mark.parametrize("seed", range(4))
def test_the_rows_of_a_window_change_with_its_unknowns_as_told(incident: Problem, seed: int) -> None:
    x = random_state(incident, seed)
    rows = incident.rows
    told = spread(rows, rows.jacobian(x), incident)
    assert set(rows.pairs[:, 1].astype(int).tolist()) >= {RANGE, RSSI, BODY_BEARING}
    expected = difference(lambda at: -in_the_open(rows, rows.residual(at)), x)
    # At short distances a bearing's Jacobian is damped on purpose, but for that by its heading.
    a, b = rows.places(x)
    bearings = np.flatnonzero(rows.pairs[:, 1] > RSSI)
    squared = ((a - b)[bearings, :2] ** 2).sum(axis=1)
    damped = (squared / (squared + bearing.NEAR_M**2))[:, None]
    units = {walk.number for walk in incident.layout.walks if walk.way is not None}
    for row, share in zip(bearings.tolist(), damped, strict=True):
        counted = rows.pairs[row, 1] == BODY_BEARING and int(rows.pairs[row, 2]) in units
        own = rows.slab[row] * incident.layout.width + rows.columns[row, 3]
        by_heading = np.zeros(len(x))
        by_heading[own] = -1.0 if counted else 0.0
        expected[row] = by_heading + share * (expected[row] - by_heading)
    assert np.abs(told - expected).max() < 1e-5 * (1.0 + np.abs(expected).max())


def test_rows_shared_out_are_the_same_to_the_last_bit(
    incident: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever a share ends: among the pairs, the singles, or between two rows of a drop."""
    x, rows = random_state(incident, 0), incident.rows
    residual, jacobian = rows.residual(x), rows.jacobian(x)
    weighted, cost = incident.weigh(residual, slack_m=0.3), incident.at(x).cost
    assert min(len(rows.pairs), len(rows.singles), len(rows.drops)) > 1
    monkeypatch.setattr(parallel, "MANY", 0)
    for cores in (2, 3, 7, len(residual)):
        monkeypatch.setattr(parallel, "get_num_threads", lambda cores=cores: cores)
        assert np.array_equal(rows.residual(x), residual)
        assert np.array_equal(rows.jacobian(x), jacobian)
        for found, expected in zip(incident.weigh(residual, slack_m=0.3), weighted, strict=True):
            assert np.array_equal(found, expected)
        assert incident.at(x).cost == cost


@pytest.mark.parametrize("seed", range(3))
def test_the_places_of_ends_change_with_their_columns_as_told(incident: Problem, seed: int) -> None:
    chance = np.random.default_rng(seed)
    layout = incident.layout
    x = random_state(incident, seed)
    numbers = chance.integers(0, len(layout.state.owners), 60)
    ends = ends_of(
        ground_of(layout), numbers, chance.uniform(0.0, 41.0, 60), chance.choice([False, True], 60)
    )
    turned = place_ends(ends.table, x).turned
    expected = difference(lambda at: place_ends(ends.table, at).place.ravel(), x).reshape(60, 3, -1)
    told = np.zeros_like(expected)
    for end in range(60):
        derivative = np.hstack([np.eye(3), turned[end]])
        for column in range(STATES):
            if ends.stood.columns[end, column] >= 0:
                told[end, :, ends.table.at[end, column]] += derivative[:, column]
            else:
                assert column < 3 or not derivative[:, column].any()
    assert np.abs(told - expected).max() < 1e-5


def test_a_moving_end_is_where_it_is_led_to_from_either_keyframe(incident: Problem) -> None:
    """At an estimate that its own motion leads to, a unit's place between keyframes lies on its way."""
    layout = incident.layout
    walk = next(i for i, w in enumerate(layout.walks) if w.way is not None)
    x = np.zeros(layout.length * layout.width + layout.border)
    keyframes = x[: layout.length * layout.width].reshape(layout.length, -1, STATES)
    way = layout.walks[walk].way
    assert way is not None
    for k in range(layout.length - 1):
        part = way.between(layout.times[k : k + 1, walk], layout.times[k + 1 : k + 2, walk])
        duration = layout.times[k + 1 : k + 2, walk] - layout.times[k : k + 1, walk]
        keyframes[k + 1, walk] = dead_reckon(keyframes[k : k + 1, walk], part[:, :3], part[:, 3:6], duration)[
            0
        ][0]
    t = np.linspace(0.0, 40.0, 301)
    ends = ends_of(
        ground_of(layout), np.full(len(t), layout.walks[walk].number), t, np.zeros(len(t), dtype=bool)
    )
    places = place_ends(ends.table, x).place
    sums = way.between(np.zeros(len(t)), t)
    assert np.abs(places - sums[:, :3]).max() < 1e-9
    assert np.abs(np.diff(places, axis=0)).max() < physics.FASTEST_MPS
