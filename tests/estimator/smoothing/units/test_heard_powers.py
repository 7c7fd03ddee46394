"""What powers of a walk cost."""

import numpy as np

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.smoothing.units.heard_powers import MOST, power_costs


def test_powers_of_a_walk_are_counted_since_an_epoch_and_cost_no_more_than_an_outlier() -> None:
    pairs = np.zeros((5, 11))
    pairs[:, 0], pairs[:, 1], pairs[:, 2], pairs[:, 3] = (
        (1, 5, 6, 7, 8),
        RSSI,
        (1, 1, 2, 1, 1),
        (9, 9, 9, 1, 9),
    )
    pairs[4, 1] = RANGE
    off_db, variance = np.array([6.0, 6.0, 6.0, 60.0, 1.0]), np.full(5, 36.0)
    found = power_costs(pairs, off_db, variance, 2.0, np.array([1.0, 2.0]))
    assert found.tolist() == [[0.5 + MOST, 2.0, 1.0], [0.5, 1.0, 0.0]]
