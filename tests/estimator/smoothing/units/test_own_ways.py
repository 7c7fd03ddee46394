"""Where units lead that go their own way from where they began."""

import numpy as np
import pytest

from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.units.own_ways import own_ways
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of
from tests.estimator.trackers.entry import BASE, step

SECONDS, DROPPED_S = 30, 12
ELSEWHERE_M = 5.0


def test_a_unit_leads_on_from_where_it_begins_and_what_was_dropped_lies_on_its_way() -> None:
    entry = [Node(t=0.0, node=name, role="responder", position_m=(0.0, 0.0, 0.0)) for name in ("ff1", "ff2")]
    crumb = Node(t=float(DROPPED_S), node="b1", role="breadcrumb")
    steps = [step(float(second)) for second in range(1, SECONDS + 1)]
    ranges = [Range(t=20.0, a=one, b="b1", range_m=8.0, technology="uwb") for one in ("ff1", "ff2")]
    dropped = Drop(t=float(DROPPED_S), node="b1", by="ff1")
    problem, solved = solved_of([BASE, *entry, crumb, *steps, dropped, *ranges])
    layout, size = problem.layout, problem.layout.length * problem.layout.width
    at = next(i for i, walk in enumerate(layout.walks) if walk.way is not None)
    bent = solved.x.copy()
    bent[layout.width : size] += np.random.default_rng(0).normal(0.0, ELSEWHERE_M, size - layout.width)
    start = size + layout.stands[layout.state.nodes["b1"].index]
    bent[start : start + 3] += ELSEWHERE_M

    led = own_ways(problem, bent, {layout.walks[at].number: at})

    way_m = layout.states(led, at)[:, :2]
    told_m = np.outer(layout.times[:, at] - layout.times[0, at], (0.8, 0.3))
    psi = layout.states(bent, at)[0, 3]
    assert psi == pytest.approx(0.0, abs=0.1)
    cosine, sine = np.cos(psi), np.sin(psi)
    faced_m = told_m @ np.array([[cosine, sine], [-sine, cosine]])
    scale = 1.0 + layout.states(bent, at)[0, 5]
    assert way_m - way_m[0] == pytest.approx(scale * faced_m, abs=0.05)
    crumb_m = [np.interp(DROPPED_S, layout.times[:, at], way_m[:, c]) for c in range(2)]
    assert led[start : start + 2] == pytest.approx(crumb_m)
    others = [i for i in range(len(layout.walks)) if i != at]
    for i in others:
        assert np.array_equal(layout.states(led, i), layout.states(bent, i))
