"""Rows of readings among the groups of a chain."""

import numpy as np

from estimator.graph.assembly import localise


def test_rows_come_group_after_group_in_their_order() -> None:
    # Two blocks of two columns, each a group; a border of one, which a third group has alone.
    columns = np.array([[2, 4], [4, -1], [0, -1], [3, -1]])
    place = np.array([[0, 1, -1, -1, 2], [-1, -1, 0, 1, 2], [-1, -1, -1, -1, 0]])

    found, order, ends = localise(columns, 4, 2, np.array([0, 1]), place)

    assert found.tolist() == [[0, 2], [0, -1], [0, -1], [1, -1]]
    assert order.tolist() == [2, 0, 3, 1]
    assert ends.tolist() == [0, 1, 3, 4]
