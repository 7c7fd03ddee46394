"""Inside a displacement over a long time nobody knows his way, and no reading there tells it by itself."""

import numpy as np
import pytest

from estimator.fusion.memory.state import FusionState
from estimator.fusion.readings.between_reports import unsure_m2
from estimator.fusion.tick import fold_tick
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range

CORNER_T = 4.0


def report(period_s: float, *heard: Range | Drop) -> FusionState:
    """Who goes east for the time of one report, and what is heard of him meanwhile."""
    state = FusionState()
    begins = [
        Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
        Node(
            t=0.0,
            node="ff1",
            role="responder",
            position_m=(0.0, 0.0, 0.0),
            sigma_m=0.1,
            heading_sigma_rad=0.01,
        ),
        Node(t=0.0, node="a1", role="anchor", position_m=(CORNER_T, -10.0, 0.0), sigma_m=0.01),
    ]
    fold_tick(state, 0.5, begins)
    told = Displacement(t=period_s, from_t=0.0, node="ff1", delta_m=(period_s, 0.0, 0.0))
    fold_tick(state, period_s, [*heard, told])
    return state


def range_at(t: float) -> Range:
    return Range(t=t, a="ff1", b="a1", range_m=7.0, sigma_m=0.1, technology="uwb")


def north_m(state: FusionState) -> tuple[float, float]:
    """Where the responder is, and its standard deviation."""
    at = state.graph.rows(state.nodes["ff1"].position).start + 1
    return float(state.graph.reference[at]), float(np.sqrt(state.graph.covariance()[at, at]))


def test_a_place_is_least_known_halfway_between_two_reports_and_known_at_both() -> None:
    node = report(8.0).nodes["ff1"]
    assert unsure_m2(node, 4.0) == pytest.approx([2.0, 2.0, 0.2])
    assert unsure_m2(node, 1.0)[0] == pytest.approx(7.0 / 8.0)
    assert unsure_m2(node, 0.0) == pytest.approx(np.zeros(3))
    assert unsure_m2(node, 8.0) == pytest.approx(np.zeros(3))
    assert unsure_m2(report(3.0).nodes["ff1"], 1.5) == pytest.approx(np.zeros(3))


def test_a_range_between_two_reports_does_not_surely_move_their_ends() -> None:
    """He has gone by a way of his own: three metres nearer to the anchor than his chord."""
    (without, _), (told, sigma_m) = north_m(report(8.0)), north_m(report(8.0, range_at(CORNER_T)))
    assert abs(told - without) < 0.3
    assert sigma_m > 0.09
    many = north_m(report(8.0, *(range_at(CORNER_T + 0.1 * i) for i in range(-10, 11))))
    assert abs(many[0] - without) < 3.0 * many[1]


def test_a_breadcrumb_that_was_dropped_between_two_reports_lies_about_where_he_was() -> None:
    state = report(8.0, Drop(t=CORNER_T, node="b1", by="ff1"))
    at = state.graph.rows(state.nodes["b1"].position).start
    assert state.graph.covariance()[at, at] == pytest.approx(0.5**2 + 2.0 + north_m(state)[1] ** 2, rel=0.3)
