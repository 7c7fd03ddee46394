"""Displacements summed up along a way."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.memory.ledger import ASSUMED, UNSEEN
from estimator.fusion.motion.silence import wandered_m2
from estimator.smoothing.keyframes.displacement_sums import LAID, SummedEnds, Way, set_sums_of

Steps = np.ndarray[tuple[int, int], np.dtype[np.float64]]


def walked(seed: int, seconds: int = 20) -> Steps:
    """Rows of the ledger for steps of a second each, from 100 s on, with a pause after every fifth."""
    chance = np.random.default_rng(seed)
    ends = 101.0 + np.arange(seconds) + np.arange(seconds) // 5
    steps = np.zeros((seconds, 12))
    steps[:, 0], steps[:, 2] = ends, ends - 1.0
    steps[:, 3:6] = chance.normal(0.0, 1.0, (seconds, 3))
    steps[:, 6:11] = chance.uniform(1e-4, 1e-2, (seconds, 5))
    return steps


def test_between_two_marks_a_way_is_the_sum_of_its_displacements() -> None:
    steps = walked(1)
    found = Way(100.0, steps, (1.0, 1.0)).between(steps[3:4, 0], steps[9:10, 0])[0]
    assert found[:3] == pytest.approx(steps[4:10, 3:6].sum(axis=0))
    since_s = 0.5 * (steps[4:10, 2] + steps[4:10, 0]) - steps[3, 0]
    assert found[3:6] == pytest.approx((steps[4:10, 3:6] * since_s[:, None]).sum(axis=0))
    assert found[6:8] == pytest.approx(steps[4:10, 6:8].sum(axis=0))


def test_learned_factors_scale_the_variances_that_were_assumed_and_not_those_that_a_unit_gave() -> None:
    """Nor those of heights: what is learned is learned in the plane."""
    steps = walked(2)
    steps[10:, 11] = 1.0
    plain, learned = Way(100.0, steps, (1.0, 1.0)), Way(100.0, steps, (4.0, 9.0))
    for first, last, by_place in ((0, 9, 4.0), (10, 19, 1.0)):
        since, until = steps[first : first + 1, 0], steps[last : last + 1, 0]
        before, after = plain.between(since, until)[0], learned.between(since, until)[0]
        assert after[6] == pytest.approx(by_place * before[6])
        assert after[7] == pytest.approx(before[7])
        assert after[8] == pytest.approx(9.0 * before[8])


@given(
    seed=st.integers(0, 50), end=st.floats(100.0, 130.0), lengths=st.lists(st.floats(0.0, 10.0), min_size=2)
)
def test_a_way_laid_out_for_readings_is_what_lies_between_their_epochs(
    seed: int, end: float, lengths: list[float]
) -> None:
    way = Way(100.0, walked(seed), (1.0, 1.0))
    keyframes = np.array([end, *np.maximum(end - np.array(lengths), 100.0)])
    # One end after the other shares keyframe and epoch, either of them, or neither.
    since, until = (
        np.repeat(keyframes, 8),
        end + np.tile([0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0], len(keyframes)),
    )
    numbers = np.arange(len(since)) % 2
    laid = SummedEnds(*(np.full((len(since), 3), 7.0) for _ in range(3)))
    set_sums_of(way.begin_t, way.marks, way.sums, 1, numbers, since, until, laid)
    mine, said = numbers == 1, way.between(since, until)[:, :LAID]
    assert laid.delta_m[mine] == pytest.approx(said[mine, :3])
    assert laid.moment[mine] == pytest.approx(said[mine, 3:6])
    assert laid.unsure_m2[mine] == pytest.approx(np.abs(said[mine][:, [6, 6, 7]]))
    assert all((part[~mine] == 7.0).all() for part in laid), "the ends of others stay as they are"


@given(since_s=st.floats(50.0, 99.0), until_s=st.floats(100.0, 120.0), after_s=st.floats(125.0, 200.0))
def test_before_its_first_displacement_and_after_its_last_a_bearer_may_have_walked(
    since_s: float, until_s: float, after_s: float
) -> None:
    way = Way(100.0, walked(4), (1.0, 1.0))
    first, last = 100.0, float(walked(4)[-1, 0])
    since, until, inside = (np.array([t]) for t in (since_s, until_s, first))
    wandered = wandered_m2(first - since_s, np.inf)
    said = way.between(since, until)[0] - way.between(inside, until)[0]
    assert said[6:8] == pytest.approx([wandered, 0.1 * wandered])
    assert said[:3] == pytest.approx(0.0)
    assert way.between(since, np.array([after_s]))[0][6] == pytest.approx(
        wandered + way.between(inside, np.array([last]))[0][6] + wandered_m2(after_s - last, np.inf)
    )


def test_inside_a_long_displacement_a_unit_may_have_been_anywhere_between_its_ends() -> None:
    steps = walked(3, 2)
    steps[1, 2], steps[1, 0] = 101.0, 121.0
    unsure = Way(100.0, steps, (1.0, 1.0)).bridged(np.array([100.5, 101.0, 106.0, 111.0, 116.0, 121.0]))
    assert unsure[[0, 1, 5]].tolist() == [0.0, 0.0, 0.0]
    assert unsure[3] == unsure.max() > 0.0
    assert unsure[2] == pytest.approx(unsure[4])


def told(*spans: tuple[float, float, float, float]) -> Steps:
    """Rows of the ledger: since when, until when, variance across (m²), and whose noise that is."""
    steps = np.zeros((len(spans), 12))
    for row, (since_t, t, across2, given_by) in zip(steps, spans, strict=True):
        row[[0, 2, 6, 11]] = t, since_t, across2, given_by
    return steps


def test_a_silence_is_what_no_report_interrupts() -> None:
    heard, lost = 1e-3, physics.GAP_MPS**2
    way = Way(
        0.0,
        told(
            (0.0, 1.0, heard, ASSUMED),
            # Two packets that are lost, with a report between them.
            (1.0, 3.0, lost, ASSUMED),
            (3.0, 5.0, lost, ASSUMED),
            # Silence, and the report after it that does not say since when it sums up.
            (5.0, 8.0, 1.0, UNSEEN),
            (8.0, 10.0, lost, ASSUMED),
            (10.0, 11.0, heard, ASSUMED),
        ),
        (1.0, 1.0),
    )
    assert way.silences(0.0, 12.0) == pytest.approx(np.array([[5.0, 9.0]]), abs=0.1)
    assert way.silences(-6.0, 16.0) == pytest.approx(
        np.array([[-6.0, 0.0], [5.0, 9.0], [11.0, 16.0]]), abs=0.1
    )
