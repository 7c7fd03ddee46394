"""Which images of a way are solved as a whole, among people whom no reading ties to each other."""

from typing import NamedTuple

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.smoothing.images import solutions
from estimator.smoothing.images.likeliest import Judged, likeliest
from tests.estimator.smoothing.images.test_among import SECONDS, stroll
from tests.estimator.smoothing.images.test_flips import solved_of

SEEDS = range(4)


class Told(NamedTuple):
    """What is known of everybody's images, and how many were solved with everything."""

    judged: Judged
    solved: int


def two(seed: int) -> list[AnyReading]:
    """Two stroll through a room; neither hears the other."""
    readings, _ = stroll(seed)
    other = [replace(r, a="ff2") for r in stroll(seed + 50)[0] if isinstance(r, Rssi)]
    return [*readings, Node(t=0.0, node="ff2", role="responder"), *other]


def told(monkeypatch: pytest.MonkeyPatch, seed: int, alone: float) -> Told:
    """What is told where images that cost so much more, with all others held, are given up."""
    count, solve = 0, solutions._solved

    def counted(*asked: object) -> object:
        nonlocal count
        count += 1
        return solve(*asked)  # type: ignore[arg-type]

    with monkeypatch.context() as patch:
        patch.setattr(solutions, "ALONE", alone)
        patch.setattr(solutions, "_solved", counted)
        return Told(likeliest(*solved_of(two(seed))), count)


def test_fewer_are_solved_as_a_whole_and_everybody_is_where_he_is(monkeypatch: pytest.MonkeyPatch) -> None:
    few = [told(monkeypatch, seed, solutions.ALONE) for seed in SEEDS]
    many = [told(monkeypatch, seed, solutions.HELD) for seed in SEEDS]
    assert sum(one.solved for one in few) < 0.8 * sum(one.solved for one in many)
    for seed, one in zip(SEEDS, few, strict=True):
        problem, solved = one.judged.problem, one.judged.solved
        at = np.clip(problem.layout.grid.astype(int) - 1, 0, SECONDS - 1)
        for i, way_m in enumerate((stroll(seed)[1], stroll(seed + 50)[1])):
            off_m = problem.layout.states(solved.x, i)[:, :2] - way_m[at]
            assert np.sqrt((off_m**2).sum(axis=1).mean()) < 4.0
