"""Since when somebody crawls, and what is told of it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.memory.ledger import COLUMNS, SCALE2, UNSEEN
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.changed_gait import began
from estimator.fusion.tick import fold_tick
from estimator.graph.dense import Array
from estimator.measurements.node import Node
from tests.estimator.trackers.entry import BASE, step

WALK, CRAWL = 1.1, 0.4


def told(paces_mps: list[float], each_s: float = 1.0) -> Array:
    """Rows of the ledger for displacements at these paces."""
    rows = np.zeros((len(paces_mps), len(COLUMNS["steps"])))
    rows[:, 0] = each_s * np.arange(1, len(rows) + 1)
    rows[:, 2] = rows[:, 0] - each_s
    rows[:, 3] = np.array(paces_mps) * each_s
    return rows


@given(st.integers(4, 20), st.integers(4, 11), st.booleans(), st.integers(0, 99))
def test_it_began_where_the_pace_changed(before: int, since: int, slow: bool, seed: int) -> None:
    was, now = (WALK, CRAWL) if slow else (CRAWL, WALK)
    spread = np.random.default_rng(seed).uniform(0.9, 1.1, before + since)
    rows = told((spread * ([was] * before + [now] * since)).tolist())
    assert began(rows, slow) == before


@given(st.lists(st.floats(0.2, 0.6), min_size=1, max_size=12))
def test_who_has_crawled_from_the_first_on_began_with_that(paces_mps: list[float]) -> None:
    assert began(told(paces_mps), slow=True) == 0


@given(st.integers(1, 6), st.integers(1, 6))
def test_who_began_at_a_pace_that_says_neither_had_not_walked(faster: int, slower: int) -> None:
    paces_mps = [physics.WALKS_MPS - 0.02] * faster + [physics.CRAWLS_MPS + 0.02] * slower
    assert began(told(paces_mps), slow=True) == 0


def test_who_stood_in_between_began_before_that() -> None:
    assert began(told([WALK] * 10 + [CRAWL] * 5 + [0.0] * 30 + [CRAWL] * 4), slow=True) == 10


def test_of_a_boot_that_tells_parts_of_its_strides_it_is_the_pace_of_its_bearer() -> None:
    """In each second it stands for half of the time."""
    strides = [0.0, 0.0, 2.0, 2.0]
    paces_mps = [WALK * part for part in strides * 8] + [CRAWL * part for part in strides * 8]
    assert began(told(paces_mps, 0.25), slow=True) == pytest.approx(32, abs=2)


def test_what_nobody_has_seen_tells_no_pace() -> None:
    rows = told([WALK] * 10 + [CRAWL] * 6)
    unseen = told([0.2] * 3)
    unseen[:, -1] = UNSEEN
    rows = np.vstack([rows[:10], unseen, rows[10:]])
    rows[:, 0] = np.arange(1, len(rows) + 1)
    rows[:, 2] = rows[:, 0] - 1.0
    assert began(rows, slow=True) == 13


def test_what_was_found_in_between_and_takes_no_time_is_no_pace() -> None:
    """A step that slipped stands in the ledger once more: a row without displacement or time."""
    rows = told([WALK] * 13 + [CRAWL] * 3)
    rows[0, -1] = UNSEEN
    slip = rows[1:2].copy()
    slip[0, [0, 2]] = 1.0
    slip[0, 3] = 0.0
    assert began(np.vstack([rows[:1], slip, rows[1:]]), slow=True) == 14


def test_it_began_after_it_has_changed_before() -> None:
    """Who walked between two crawls for some steps only."""
    rows = told([CRAWL] * 9 + [WALK] * 3 + [CRAWL] * 4)
    assert began(rows, slow=True) == 0
    rows[8, SCALE2] = physics.SCALE_SIGMA**2
    assert began(rows, slow=True) == 12


def test_the_window_is_told_of_when_somebody_began_to_crawl_and_the_filter_of_how_far_he_has() -> None:
    state = FusionState()
    fold_tick(state, 0.5, [BASE, Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))])
    before = 0.0
    for second in range(1, 61):
        pace_mps = WALK if second <= 30 else CRAWL
        fold_tick(state, float(second), [step(float(second), (pace_mps, 0.0, 0.0))])
        row = state.graph.starts[state.nodes["ff1"].unit] + 2
        if state.nodes["ff1"].gait.slow:
            break
        before = float(state.graph.covariance()[row, row])
    steps = state.ledger.table("steps")
    renewed = steps[steps[:, SCALE2] > physics.SCALE_SIGMA**2]
    assert renewed[:, 0].tolist() == [30.0]
    assert not renewed[:, 3:10].any()
    covariance, east = state.graph.covariance(), state.graph.starts[state.nodes["ff1"].position]
    assert before < physics.SCALE_SIGMA**2 * 1.01
    assert covariance[row, row] == pytest.approx(physics.CRAWL_SCALE_SIGMA**2, rel=0.05)
    crawled_m = CRAWL * (second - 30)
    assert covariance[east, row] == pytest.approx(crawled_m * covariance[row, row], rel=0.35)
