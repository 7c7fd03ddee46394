"""How the walks of a window go between their keyframes."""

import numpy as np

from estimator.fusion.entering.unit_mounting import RIGHT
from estimator.measurements.node import Node
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.keyframes.walks import unit_motion
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of
from tests.estimator.trackers.test_unit_mounting import entry


def test_a_unit_moves_as_it_does_by_itself_whoever_walks_beside_it() -> None:
    readings, _ = entry(RIGHT, 0)
    late = [r for r in readings if r.t <= 40.0 and (getattr(r, "node", "") != "ff2" or r.t >= 20.0)]
    late.append(Node(t=20.0, node="ff2", role="responder", position_m=(5.0, 5.0, 0.0), sigma_m=0.3))
    problem, solved = solved_of(sorted(late, key=lambda r: r.t))
    layout, found = problem.layout, problem.motions(solved.x)
    assert len({walk.first for walk in layout.walks}) > 1
    for i, (walk, motion) in enumerate(zip(layout.walks, found, strict=True)):
        assert walk.way is not None
        times = layout.times[walk.first : walk.last + 1, i]
        states = layout.states(solved.x, i)[walk.first : walk.last + 1].copy()
        alone = unit_motion(walk.way.between(times[:-1], times[1:]), np.diff(times), states)
        for one, expected in zip(motion, alone, strict=True):
            assert np.array_equal(one, expected)


def test_a_part_of_a_window_moves_as_the_whole_does_up_to_its_last_keyframe() -> None:
    problem, solved = solved_of([r for r in entry(RIGHT, 0)[0] if r.t <= 40.0])
    numbers = Unknowns(problem.layout, [0, 2], problem.layout.length // 2)
    part = problem.going.part(numbers).motions(numbers.taken(solved.x))
    whole = problem.motions(solved.x)
    for one, of in zip(part, (whole[0], whole[2]), strict=True):
        for some, every in zip(one, of, strict=True):
            assert np.array_equal(some, every[: len(some)])
            assert 0 < len(some) < len(every)
