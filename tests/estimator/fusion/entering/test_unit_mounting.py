"""How a unit is worn: what it reports is turned, or left and right are exchanged."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fusion.entering.unit_mounting import RIGHT, Mounting, mount, mounting_of, reported
from estimator.fusion.memory.ledger import GYRO_BIAS
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.inertial.levelling import ANYWHERE_RAD
from estimator.measurements.displacement import Displacement

WAYS = [Mounting(True), Mounting(False, 0.5 * math.pi), Mounting(True, 1.0), Mounting(False, -2.0)]


@pytest.mark.parametrize("one", WAYS)
@pytest.mark.parametrize("other", WAYS)
def test_one_way_after_another_is_what_both_make_of_a_displacement(one: Mounting, other: Mounting) -> None:
    assert np.allclose(other.after(one).of(3.0, 1.0), other.of(*one.of(3.0, 1.0)))


@pytest.mark.parametrize("way", WAYS)
def test_a_way_is_taken_back(way: Mounting) -> None:
    assert np.allclose(way.back().after(way).of(3.0, 1.0), (3.0, 1.0))


@pytest.mark.parametrize("way", WAYS)
def test_who_walks_as_he_faces_does_so_worn_any_way(way: Mounting) -> None:
    node = NodeState(node="ff1", role="responder", t=0.0, worn=(way.mirrored, way.turned_rad))
    said = Displacement(
        t=1.0, node="ff1", delta_m=(2.0 * math.cos(0.7), 2.0 * math.sin(0.7), 0.5), heading_rad=0.7
    )
    found = reported(node, said)
    assert found.heading_rad is not None
    assert np.allclose(
        found.delta_m, (2.0 * math.cos(found.heading_rad), 2.0 * math.sin(found.heading_rad), 0.5)
    )


def test_what_a_unit_has_reported_is_worn_so_from_its_beginning_and_taken_back() -> None:
    state = FusionState()
    node = state.node_of("ff1", "responder", 0.0)
    state.nodes["ff1"] = replace(node, trail=((0.0, 0.0, 0.0, 0.0), (1.0, 3.0, 1.0, 0.0)))
    state.ledger.add("steps", 1.0, node.index, 0.0, 3.0, 1.0, *(0.0,) * 7)
    state.ledger.add("steps", 1.0, node.index + 1, 0.0, 3.0, 1.0, *(0.0,) * 7)
    state.ledger.add("singles", 1.0, node.index, GYRO_BIAS, 0.01, 0.001, 0.0, -1.0)
    mount(state, node.index, Mounting(True))
    assert state.ledger.table("steps")[:, 3:5].tolist() == [[3.0, -1.0], [3.0, 1.0]]
    assert state.ledger.table("singles")[0, 3] == -0.01
    assert state.nodes["ff1"].trail[-1] == (1.0, 3.0, -1.0, 0.0)
    mount(state, node.index, RIGHT)
    assert state.ledger.table("steps")[:, 3:5].tolist() == [[3.0, 1.0], [3.0, 1.0]]
    assert mounting_of(state.nodes["ff1"]) == RIGHT


def test_what_was_told_of_a_turned_units_heading_says_nothing_and_is_believed_again_with_it() -> None:
    state = FusionState()
    node = replace(state.node_of("ff1", "responder", 0.0), heading_sigma_rad=0.05)
    state.nodes["ff1"] = node
    state.ledger.add("begins", 0.0, node.index, 1.0, 0.0, *(0.0,) * 6, 0.0, 0.05)
    mount(state, node.index, Mounting(False, 1.0))
    assert state.ledger.table("begins")[0, 11] == ANYWHERE_RAD
    mount(state, node.index, RIGHT)
    assert state.ledger.table("begins")[0, 11] == 0.05
