"""Which images of a way are solved as a whole, among people whom no reading ties to each other."""

from typing import NamedTuple

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fusion.images import Image
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.smoothing.images import solutions
from estimator.smoothing.images.flip_ambiguity import Flip
from estimator.smoothing.images.image_starts import ImageEnd, ImageSolution, ImageStart, Subject
from estimator.smoothing.images.likeliest_image import JudgedImages, likeliest_image
from estimator.smoothing.images.local_solution import is_law, local_solution
from estimator.smoothing.images.parts import Parts
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of
from tests.estimator.smoothing.images.test_near_radios import DBM, EXPONENT, SECONDS, SIGMA_DB, stroll

SEEDS = range(4)


class Told(NamedTuple):
    """What is known of everybody's images, and how many were solved with everything."""

    judged: JudgedImages
    solved: int


def two(seed: int) -> list[AnyReading]:
    """Two stroll through a room; neither hears the other."""
    readings, _ = stroll(seed)
    other = [replace(r, a="ff2") for r in stroll(seed + 50)[0] if isinstance(r, Rssi)]
    return [*readings, Node(t=0.0, node="ff2", role="responder"), *other]


def side_by_side(seed: int) -> list[AnyReading]:
    """The same two, who hear each other."""
    chance, ways_m = np.random.default_rng(seed), (stroll(seed)[1], stroll(seed + 50)[1])
    readings = two(seed)
    for second, (one, other) in enumerate(zip(*ways_m, strict=True), start=1):
        distance_m = float(np.sqrt(((one - other) ** 2).sum() + 1.0))
        dbm = DBM - 10.0 * EXPONENT * np.log10(distance_m) + chance.normal(0.0, SIGMA_DB)
        readings.append(Rssi(t=float(second), a="ff1", b="ff2", dbm=float(dbm)))
    return readings


def off_m(judged: JudgedImages, seed: int) -> list[float]:
    """How far off the two are, root mean square (m)."""
    layout, found = judged.problem.layout, []
    at = np.clip(layout.grid.astype(int) - 1, 0, SECONDS - 1)
    for i, way_m in enumerate((stroll(seed)[1], stroll(seed + 50)[1])):
        apart = layout.states(judged.solved.x, i)[:, :2] - way_m[at]
        found.append(float(np.sqrt((apart**2).sum(axis=1).mean())))
    return found


def told(monkeypatch: pytest.MonkeyPatch, seed: int, alone: float) -> Told:
    """What is told where images that cost so much more, with all others held, are given up."""
    count = 0

    def counted(problem: Problem, x: Array, slacks_m: tuple[float, ...], known: Solution) -> Solution | None:
        nonlocal count
        count += 1
        return local_solution(problem, x, slacks_m, known)

    with monkeypatch.context() as patch:
        patch.setattr(solutions, "ALONE", alone)
        patch.setattr(solutions, "local_solution", counted)
        return Told(likeliest_image(*solved_of(two(seed))), count)


def test_fewer_are_solved_as_a_whole_and_everybody_is_where_he_is(monkeypatch: pytest.MonkeyPatch) -> None:
    few = [told(monkeypatch, seed, solutions.ALONE) for seed in SEEDS]
    many = [told(monkeypatch, seed, solutions.HELD) for seed in SEEDS]
    assert sum(one.solved for one in few) < 0.8 * sum(one.solved for one in many)
    for seed, one in zip(SEEDS, few, strict=True):
        assert max(off_m(one.judged, seed)) < 4.0


@pytest.mark.parametrize("seed", SEEDS)
def test_a_law_that_is_nearly_flat_leads_nobody_on_top_of_strong_radios(seed: int) -> None:
    """By an exponent of 0.3 it fits 50 better, in log likelihood, and they were 5 to 7 m off."""
    judged = likeliest_image(*solved_of(side_by_side(seed)))
    assert is_law(judged.problem.layout, judged.solved.x)
    assert max(off_m(judged, seed)) < 4.0


def test_what_leads_nearest_is_solved_first_however_far_off_it_began(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two images of a way, of which one may be solved as a whole; the second leads to what costs less."""
    problem, solved = solved_of(two(0))
    starts = []
    for k, east_m in enumerate((40.0, -40.0)):
        x = solved.x.copy()
        problem.layout.states(x, 0)[:, 0] += east_m
        starts.append(ImageStart(x, Flip(5 * k, Image())))
    asked, tried = Subject(problem, 0, whole=False), list[float]()

    def led(_: Subject, __: Parts, ___: ImageSolution, start: ImageStart, ____: bool) -> ImageEnd:
        return ImageEnd(start, 8.0 - start.flip.since)

    def noted(_: Problem, x: Array, *__: object) -> None:
        tried.append(float((x - solved.x)[0]))

    monkeypatch.setattr(solutions, "_led", led)
    monkeypatch.setattr(solutions, "local_solution", noted)
    solutions.solutions(asked, Parts(problem, solved.x), solved, starts, 1)
    assert tried == [pytest.approx(-40.0)]
