"""A power falls with the logarithm of a distance, of which a linear state knows a tangent."""

import numpy as np
import pytest

from estimator.fusion.memory.ledger import RSSI
from estimator.fusion.rows.power_curvature import logarithm_error, sight_offsets
from estimator.fusion.rows.rows import B_E, EXTRA, FIELDS, KIND, VALUE, WIDTH, A, B, columns_of, linearise
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.trackers.kirchhoff import KirchhoffTracker

X = np.array([3.0, 4.0, 0.0, -40.0, 2.5])


@pytest.mark.parametrize("aside", [0.01, 0.1, 1.0, 10.0, 100.0])
@pytest.mark.parametrize("farther", [0.0, 0.01, 0.04, 1.0, 4.0])
def test_the_logarithm_is_as_far_off_its_tangent_as_drawn_places_are(aside: float, farther: float) -> None:
    psi, rho = np.random.default_rng(3).normal(0.0, 1.0, (2, 200_000)) * np.sqrt([[aside], [farther]])
    drawn = np.mean((0.5 * np.log((1.0 + rho) ** 2 + psi**2) - rho) ** 2)
    told = logarithm_error(aside, farther)
    assert 0.5 * drawn < told < 2.1 * drawn


def test_a_place_leads_aside_and_farther_as_seen_from_the_radio() -> None:
    """A radio 10 m east: a step north is a tenth of a radian, a step west a tenth of the way more."""
    table = np.zeros((1, FIELDS))
    table[:, KIND], table[:, A], table[:, B], table[:, EXTRA] = RSSI, 0, -1, 3
    table[:, B_E], table[:, B_E + 1], table[:, VALUE] = 13.0, 4.0, -70.0
    columns, jacobian, residual = columns_of(table), np.empty((1, WIDTH)), np.empty(1)
    linearise(table, columns, X, jacobian, residual)
    aside, farther, slopes_db = np.empty((1, WIDTH)), np.empty((1, WIDTH)), np.empty(1)
    sight_offsets(columns, jacobian, X, aside, farther, slopes_db)
    assert np.abs(aside[0, :3]) == pytest.approx([0.0, 0.1, 0.0], rel=1e-2)
    assert np.abs(farther[0, :3]) == pytest.approx([0.1, 0.0, 0.0], rel=1e-2)
    assert slopes_db == pytest.approx([25.0 / np.log(10.0)])


def sure_m(apart_m: float) -> float:
    """How surely somebody without a unit, known to 20 m, is placed by one power of a known breadcrumb (m)."""
    readings: list[AnyReading] = [
        Node(t=0.0, node="b1", role="breadcrumb", position_m=(0.0, 0.0, 0.0), sigma_m=0.05),
        Node(t=0.0, node="ff1", role="responder", position_m=(apart_m, 0.0, 0.0), sigma_m=20.0),
        Rssi(t=1.0, a="ff1", b="b1", dbm=-60.0),
    ]
    tracker = KirchhoffTracker()
    tracker.fold(readings)
    covariance = next(e for e in tracker.estimates() if e.node == "ff1").covariance_m2
    assert covariance is not None
    ee, en, _, nn, _, _ = covariance
    return float(np.sqrt(np.linalg.eigvalsh([[ee, en], [en, nn]])[0]))


@pytest.mark.parametrize("apart_m", [1.0, 3.0, 6.0])
def test_who_may_be_anywhere_is_not_pinned_beside_a_radio_by_one_power(apart_m: float) -> None:
    """It comes from 3 to 12 m: that is told, and no more."""
    assert 4.0 < sure_m(apart_m) < 15.0
