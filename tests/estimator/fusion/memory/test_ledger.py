"""What has been fused, as tables."""

import numpy as np

from estimator.fusion.memory.ledger import COLUMNS, MERGED, Ledger

WIDTH = len(COLUMNS["pairs"])


def test_rows_keep_their_order_however_they_come_in_and_are_joined() -> None:
    chance, ledger, expected = np.random.default_rng(1), Ledger(), []
    for _ in range(5 * MERGED):
        rows = chance.normal(0.0, 1.0, (int(chance.integers(1, 9)), WIDTH))
        expected.append(rows)
        if len(rows) == 1:
            ledger.add("pairs", *rows[0].tolist())
        else:
            ledger.extend("pairs", rows)
        assert len(ledger.chunks["pairs"]) <= MERGED
    assert (ledger.table("pairs") == np.concatenate(expected)).all()


def test_a_copy_shares_nothing_that_changes() -> None:
    ledger = Ledger()
    ledger.add("drops", 1.0, 2.0, 3.0)
    twin = ledger.copy()
    twin.extend("drops", np.ones((2, 3)))
    assert len(ledger.table("drops")) == 1
    assert len(twin.table("drops")) == 3
