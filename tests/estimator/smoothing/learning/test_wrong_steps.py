"""Steps that a unit has reported wrongly are told from its noise, and from what walls do to ranges."""

import math
from collections.abc import Mapping

import numpy as np
import pytest

from estimator.fusion.memory.state import FusionState
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.learning.slips import Slip, widen_steps
from estimator.smoothing.learning.wrong_steps import disturbance_covariance, doubts_of, find_slips, gains
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.smoothing.windows import entered, fused, problem_of, unlikelihood

ANCHORS = {"north": (0.0, 30.0, 2.0), "east": (30.0, -5.0, 2.0), "west": (-25.0, -10.0, 2.0)}
SECONDS, AT_S, RANGE_M = 120, 61, 0.1


def place(second: float) -> np.ndarray:
    """Round a circle of 10 m at 1 m/s."""
    turned = 0.1 * second
    return np.array([10.0 * math.sin(turned), 5.0 - 10.0 * math.cos(turned)])


def walk(
    slipped: tuple[float, float] = (0.0, 0.0), too_long_m: Mapping[str, float] | None = None, seed: int = 1
) -> list[AnyReading]:
    """Readings of a walker among three anchors.

    Args:
        slipped: what the step at `AT_S` is reported too much: east, north (m).
        too_long_m: by how much the ranges to an anchor are too long from then on (m).
        seed: of the noise.
    """
    chance = np.random.default_rng(seed)
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=at, sigma_m=0.01) for name, at in ANCHORS.items()
    ]
    readings.append(entered(*place(0.0).tolist()))
    for second in range(1, SECONDS + 1):
        delta = place(second) - place(second - 1.0) + chance.normal(0.0, 0.03, 2)
        delta += np.array(slipped) * (second == AT_S)
        readings.append(
            Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(*delta.tolist(), 0.0))
        )
        for name, at in ANCHORS.items():
            distance = math.dist((*place(second), 0.0), at) + RANGE_M * chance.normal()
            distance += (too_long_m or {}).get(name, 0.0) * (second >= AT_S)
            readings.append(Range(t=float(second), a="ff1", b=name, range_m=distance, technology="uwb"))
    return readings


def slips_of(state: FusionState) -> list[Slip]:
    problem = problem_of(state)
    solved = problem.solve(problem.layout.start())
    solved.chain.solve()
    found, ahead, _ = solved.chain.covariances()
    return find_slips(problem, solved, doubts_of(problem, solved, found, ahead), problem_of)


def said(readings: list[AnyReading]) -> tuple[list[str], list[float]]:
    """What the tracker says of slips second by second, and how far off it is after each second (m)."""
    tracker, texts, off = KirchhoffTracker(), [], []
    for second in range(SECONDS + 1):
        tracker.fold([r for r in readings if second - 1.0 < r.t <= second])
        texts += [n.text for n in tracker.take_notices() if n.code == "outlier" and "slid" in n.text]
        here = next(e for e in tracker.estimates() if e.node == "ff1").position_m
        off.append(math.dist(here[:2], place(second)) if here is not None else math.inf)
    return texts, off


@pytest.mark.parametrize("slipped", [(1.0, 0.0), (-0.5, 0.9), (0.0, -1.2)])
def test_a_stumble_is_found_where_it_happened(slipped: tuple[float, float]) -> None:
    texts, off = said(walk(slipped))
    assert len(texts) == 1
    assert texts[0].startswith("ff1 reported a step wrongly")
    assert max(off[AT_S + 20 :]) < 0.4


@pytest.mark.parametrize("seed", range(4))
def test_noise_is_no_stumble(seed: int) -> None:
    assert slips_of(fused(walk(seed=seed))) == []


def test_a_step_that_is_known_to_have_slipped_is_found_no_more() -> None:
    readings = walk((1.0, 0.0))
    state = fused(readings)
    state.ledger.replace("steps", (steps := state.ledger.table("steps"))[steps[:, 2] < steps[:, 0]])
    (slip,) = slips_of(state)
    assert slip.t == pytest.approx(AT_S - 0.5, abs=1.0)
    assert math.hypot(slip.off_m[0] + 1.0, slip.off_m[1]) < 0.4
    widen_steps(state, [slip])
    assert slips_of(state) == []


def test_the_gain_is_what_the_slip_adds_to_the_marginal_likelihood() -> None:
    state = fused(walk((0.4, 0.2)))
    problem = problem_of(state)
    solved = problem.solve(problem.layout.start())
    before = unlikelihood(problem, solved)
    weights = solved.weighted
    solved.chain.solve()
    found, ahead, _ = solved.chain.covariances()
    motion = solved.motions[0]
    gain, _ = gains(motion, disturbance_covariance(motion, found, ahead, 0, 0))
    k = int(gain.argmax())
    times = problem.layout.times[:, 0]
    widen_steps(state, [Slip(problem.layout.walks[0].number, float(times[k + 1]) - 1e-6, (0.0, 0.0))])
    slipped = problem_of(state)
    after = slipped.solve(solved.x)
    assert np.abs(after.weighted.information / weights.information - 1.0).max() < 0.2
    assert gain[k] == pytest.approx(before - unlikelihood(slipped, after), rel=0.1)
