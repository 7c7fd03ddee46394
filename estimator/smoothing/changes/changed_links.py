"""Links between two nodes that stay, whose power has changed for good.

Paper A takes that for a sign of fire.
"""

from typing import NamedTuple

import numpy as np

from estimator.fusion.memory.ledger import RSSI
from estimator.smoothing.problem.newton import Problem

CHANGED_DB = 8.0
CHANGED_SIGMAS = 4.0
LEAST_SPREAD_DB = 4.0
BEFORE_S, AFTER_S = 30.0, 20.0
LINK_READINGS_MIN = 4


class ChangedLink(NamedTuple):
    """A link between two nodes that stay, whose power has changed: names, epoch (s), change (dB)."""

    a: str
    b: str
    t: float
    change_db: float


def changed_links(problem: Problem) -> list[ChangedLink]:
    """Links between standing nodes whose power has lastingly changed in the last seconds of the window."""
    layout, pairs = problem.layout, problem.rows.pairs
    stands = np.zeros(len(layout.state.owners) + 1, dtype=bool)
    stands[[*layout.stands, -1]] = True
    still = pairs[:, 1] == RSSI
    for column in (2, 3):
        still &= stands[pairs[:, column].astype(np.intp)]
    if not still.any():
        return []
    now, found = float(layout.grid[-1]), []
    # A node that was moved keeps its links, and has another number at its new place.
    between = np.column_stack([np.sort(pairs[:, 2:4], axis=1), pairs[:, 9]])
    for link in np.unique(between[still], axis=0):
        mine = pairs[still & (between == link).all(axis=1)]
        after, before = mine[mine[:, 0] > now - AFTER_S], mine[mine[:, 0] < now - BEFORE_S]
        if len(after) < LINK_READINGS_MIN or len(before) < LINK_READINGS_MIN:
            continue
        change = float(np.median(after[:, 4]) - np.median(before[:, 4]))
        spread = max(float(np.std(before[:, 4])), LEAST_SPREAD_DB)
        spread *= float(np.sqrt(1.0 / len(after) + 1.0 / len(before)))
        if abs(change) > max(CHANGED_DB, CHANGED_SIGMAS * spread):
            names = [layout.state.owners[int(n)] for n in mine[0, 2:4]]
            found.append(ChangedLink(names[0], names[1], float(after[0, 0]), change))
    return found
