"""The way of a unit between keyframes, where its bearer's gait changes."""

import numpy as np

from estimator.fusion.learned.gait import KEPT
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.displacement_sums import SUMS
from estimator.smoothing.keyframes.walks import SCALE, STATES, reckon, unit_motion

CHANGED, SCALE_SIGMA = 2, 0.1


def way() -> tuple[Array, Array, Array]:
    """Five steps of two seconds, with the third of which he begins to crawl; and where they lead."""
    between, durations_s = np.zeros((5, SUMS)), np.full(5, 2.0)
    between[:, 0], between[:, 1], between[:, 6:11] = 1.5, 0.2, 1e-3
    between[:, 10] = 1e-9
    between[CHANGED, 10] = SCALE_SIGMA**2
    states = np.zeros((6, STATES))
    states[0] = 1.0, 2.0, 0.0, 0.4, 0.001, 0.03
    reckon(states, between, durations_s, 0)
    return between, durations_s, states


def test_a_scale_is_kept_until_the_gait_changes() -> None:
    _, _, states = way()
    np.testing.assert_allclose(states[: CHANGED + 1, SCALE], 0.03)
    np.testing.assert_allclose(states[CHANGED + 1 :, SCALE], KEPT * 0.03)


def test_a_way_that_is_reckoned_has_no_misfit() -> None:
    motion = unit_motion(*way())
    np.testing.assert_allclose(motion.residual, 0.0, atol=1e-12)


def test_derivatives_of_a_step_with_which_the_gait_changes_are_those_of_differences() -> None:
    between, durations_s, states = way()
    motion, small = unit_motion(between, durations_s, states), 1e-6
    for column in range(STATES):
        before = states[CHANGED : CHANGED + 2].copy()
        before[0, column] += small
        led = before.copy()
        reckon(led, between[CHANGED : CHANGED + 1], durations_s[:1], 0)
        by = (led[1] - states[CHANGED + 1]) / small
        np.testing.assert_allclose(motion.transition[CHANGED, :, column], by, atol=1e-5)


def test_what_the_scale_of_a_crawl_is_unsure_by_is_that_of_its_own() -> None:
    motion = unit_motion(*way())
    assert motion.noise[CHANGED, SCALE, SCALE] > SCALE_SIGMA**2 > motion.noise[0, SCALE, SCALE]
