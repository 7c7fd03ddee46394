"""What is known from before the window, if somebody had been at an image of where he was."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.images import mirrored, turned_about
from estimator.fusion.memory.prior import SIZES, Prior
from estimator.graph.dense import Array

KEYS = (("free", 0), ("walk", 1), ("stand", 2), ("range", 0), ("stand", 3))
SIZE = sum(SIZES[kind] for kind, _ in KEYS)


def cost(prior: Prior, x: Array) -> float:
    """What it costs to be somewhere, up to a constant."""
    off = x - prior.reference
    return float(0.5 * off @ prior.matrix @ off - prior.vector @ off)


@given(st.integers(0, 1000), st.floats(-3.0, 3.0))
def test_it_costs_his_image_what_it_has_cost_him(seed: int, by_rad: float) -> None:
    chance = np.random.default_rng(seed)
    rows = chance.normal(0.0, 1.0, (SIZE, SIZE))
    prior = Prior(KEYS, rows.T @ rows, chance.normal(0.0, 1.0, SIZE), chance.normal(0.0, 5.0, SIZE), {0: 1.0})
    images = {
        0: mirrored(chance.normal(0.0, 5.0, 2), by_rad),
        1: turned_about(chance.normal(0.0, 5.0, 2), by_rad),
        3: turned_about(chance.normal(0.0, 5.0, 2), -by_rad),
    }
    x = chance.normal(0.0, 5.0, SIZE)
    there, last = x.copy(), SIZE - SIZES["stand"]
    images[0].move(there[None, :6])
    for number, start in ((1, 6), (3, last)):
        there[start : start + 2] = images[number].of(x[start : start + 2])
    assert cost(prior.imaged(images), there) == pytest.approx(cost(prior, x), rel=1e-9, abs=1e-6)
    assert prior.imaged(images).epochs == prior.epochs


@given(st.integers(0, 1000))
def test_what_was_told_of_a_place_can_be_taken_out_of_it_again(seed: int) -> None:
    """Whatever else has been marginalised, what was told stands in it as it was added."""
    chance = np.random.default_rng(seed)
    rows, first = chance.normal(0.0, 1.0, (SIZE, SIZE)), sum(SIZES[kind] for kind, _ in KEYS[:2])
    matrix, vector, at = rows.T @ rows, chance.normal(0.0, 1.0, SIZE), chance.normal(0.0, 5.0, SIZE)
    mean, known = chance.normal(0.0, 5.0, 2), np.array([100.0, 25.0])
    told, own = Prior(KEYS, matrix.copy(), vector.copy(), at, {}), np.arange(first, first + 2)
    told.matrix[own, own] += known
    told.vector[own] += known * (mean - at[own])
    left = told.without(("stand", 2), mean, known)
    assert left.matrix == pytest.approx(matrix, rel=1e-9, abs=1e-9)
    assert left.vector == pytest.approx(vector, rel=1e-9, abs=1e-9)
    assert told.without(("stand", 7), mean, known) is told
