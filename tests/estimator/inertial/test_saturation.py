"""Units whose sensors end before a stride does."""

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.inertial.boot import CLIPPED
from estimator.inertial.saturation import hidden_peak, remark
from tests.estimator.inertial.boot_navigation import BLOCK, entered, track_boot
from tests.estimator.inertial.gait import STEP_S, Gait, walked

START_T, END_MPS2 = 1000.0, 20.0


def hidden(values: Array) -> tuple[Array, Array]:
    """What is doubted of each state after samples of one axis (standard deviations); what is remembered."""
    clipped, lost, variance = np.zeros(CLIPPED), np.empty(6), np.zeros(6)
    for value in values:
        hidden_peak(clipped, np.array([value, 0.0, 9.8]), np.zeros(3), STEP_S, lost)
        variance += lost
    return np.sqrt(variance), clipped


def peaks(height_mps2: float, samples: int, count: int = 1) -> Array:
    """Smooth peaks of so many samples each, no two as high, with rests between them."""
    chance = np.random.default_rng(1)
    peak = height_mps2 * np.sin(np.pi * (np.arange(samples) + 0.5) / samples) ** 2
    once = np.concatenate([np.zeros(40), peak, np.zeros(40)])
    whole = np.concatenate([once * chance.uniform(0.9, 1.0) for _ in range(count)])
    return whole + chance.normal(0.0, 0.03, len(whole))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(("height_mps2", "samples"), [(30.0, 40), (60.0, 40), (30.0, 16), (80.0, 8)])
def test_a_flat_top_is_doubted_by_about_what_it_hides(height_mps2: float, samples: int, sign: float) -> None:
    whole = sign * peaks(height_mps2, samples)
    seen = np.clip(whole, -END_MPS2, END_MPS2)
    lost_mps = abs(float(np.sum(whole - seen))) * STEP_S
    doubted, _ = hidden(seen)
    assert lost_mps / 3.0 < doubted[0] < 3.0 * lost_mps
    assert (doubted[1:] == 0.0).all()


def test_peaks_within_the_range_hide_nothing() -> None:
    doubted, clipped = hidden(peaks(30.0, 40, count=30))
    assert (doubted == 0.0).all()
    assert remark(clipped) is None


def test_a_coarse_unit_that_rests_or_strides_hides_next_to_nothing() -> None:
    """At a peak two samples may be the same, and are the most that it has told."""
    doubted, clipped = hidden(np.round(peaks(30.0, 40, count=30) / 0.2) * 0.2)
    assert doubted[0] < 0.1 * np.sqrt(30.0)
    assert remark(clipped) is None


def test_a_range_that_each_stride_goes_beyond_is_said() -> None:
    _, clipped = hidden(np.clip(peaks(30.0, 40, count=30), -END_MPS2, END_MPS2))
    text = remark(clipped)
    assert text is not None
    assert "accelerometer x ends at 20 m/s²" in text


def walk(seed: int, blow_mps: float) -> tuple[Gait, Gait]:
    """A walk whose boots come down with a blow; and what a unit with accelerometers of 2 g tells of it."""
    truth = walked(BLOCK * 2, START_T, rests_s=4.0)
    force, moving = truth.force.copy(), np.linalg.norm(truth.rate, axis=1) > 1e-6
    for end in np.flatnonzero(np.diff(moving.astype(int)) == -1):
        struck, before = slice(end - 4, end), slice(end - 20, end - 4)
        for axis, share in ((0, -0.6), (2, 1.0)):
            force[struck, axis] += share * blow_mps / (4 * STEP_S)
            force[before, axis] -= share * blow_mps / (16 * STEP_S)
    felt = truth._replace(force=force).noisy(np.random.default_rng(seed), 0.003)
    return truth, felt._replace(force=np.clip(felt.force, -END_MPS2, END_MPS2))


@pytest.mark.parametrize("blow_mps", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("seed", [0, 1])
def test_he_is_where_he_is_said_to_be(seed: int, blow_mps: float) -> None:
    truth, gait = walk(seed, blow_mps)
    notices, _ = track_boot(truth, gait, entered(START_T))
    assert [notice.code for notice in notices] == ["conflict"]
    assert "set a wider range" in notices[0].text
