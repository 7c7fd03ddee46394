"""Modes of a range-only node, and the prior of a unit's frame."""

import numpy as np
import pytest

from estimator.fusion.entering.introduce import initial_turn
from estimator.fusion.entering.modes import UndecidedNode, find_modes
from estimator.graph.dense import Array


def sought(points: Array, target: Array) -> UndecidedNode:
    chance = np.random.default_rng(4)
    distance = np.linalg.norm(points - target, axis=1) + chance.normal(0.0, 0.1, len(points))
    return UndecidedNode(
        kind="range",
        points=points,
        value=distance,
        sigma=np.full(len(points), 0.1),
        up_m=0.0,
        up_sigma_m=1.0,
        extra=np.zeros(2),
        extra_covariance=np.diag([0.02**2, 0.1**2]),
    )


def test_from_a_straight_path_both_mirror_images_are_found() -> None:
    path = np.column_stack([np.arange(20.0), np.zeros(20), np.zeros(20)])
    modes = find_modes(sought(path, np.array([8.0, 6.0, 0.0])))
    found = sorted(m.position_m[1] for m in modes[:2])
    assert found == pytest.approx([-6.0, 6.0], abs=0.5)
    assert modes[1].cost - modes[0].cost < 1.0


def test_beside_a_best_place_that_is_too_unsure_no_other_is_told() -> None:
    path = np.column_stack([np.arange(20.0), np.zeros(20), np.zeros(20)])
    best, other, *_ = find_modes(sought(path, np.array([8.0, 6.0, 0.0])))
    for unsure_m, told in ((0.5 * best.sigma_m, 1), (2.0 * best.sigma_m, 2)):
        modes = find_modes(sought(path, np.array([8.0, 6.0, 0.0])), unsure_m)
        assert [tuple(m.position_m) for m in modes[:2]] == [tuple(m.position_m) for m in (best, other)][:told]


def test_after_a_turn_one_mode_is_clearly_best() -> None:
    path = np.array([[min(k, 10.0), max(k - 10.0, 0.0), 0.0] for k in range(20)])
    modes = find_modes(sought(path, np.array([8.0, 6.0, 0.0])))
    assert np.hypot(*(modes[0].position_m[:2] - [8.0, 6.0])) < 0.5
    assert len(modes) == 1 or modes[1].cost - modes[0].cost > 7.0


@pytest.mark.parametrize(
    ("node_heading", "unit_heading", "turn"),
    [
        (None, 1.0, 0.0),
        (4.2, 4.2, 0.0),
        (1.2, 0.0, 1.2),
        (0.0, 1.5, 0.0),
        (0.4, None, 0.4),
    ],
)
def test_a_unit_s_frame_is_nominally_east_unless_its_heading_says_otherwise(
    node_heading: float | None, unit_heading: float | None, turn: float
) -> None:
    assert initial_turn(node_heading, unit_heading) == pytest.approx(turn)
