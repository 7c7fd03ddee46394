"""An incident with readings of all kinds, for the derivatives of a window."""

import numpy as np
import pytest

from estimator.fusion.memory.ledger import BODY_BEARING, RSSI
from estimator.smoothing.problem.newton import Problem
from tests.estimator.smoothing.windows import fused, problem_of
from tests.estimator.walks import two_responders


@pytest.fixture(scope="module")
def incident() -> Problem:
    """A unit, a node without one, an anchor, a beacon, breadcrumbs; ranges, RSSI, bearings, fixes, drops."""
    state = fused(two_responders(40))
    # Its bearings are absolute: some are told from the body instead, so that ψ has a part in them.
    pairs = state.ledger.table("pairs").copy()
    pairs[np.flatnonzero(pairs[:, 1] > RSSI)[::2], 1] = BODY_BEARING
    state.ledger.replace("pairs", pairs)
    # And some single readings tell a height, a gyro bias and a scale.
    singles = state.ledger.table("singles").copy()
    singles[:3, 2] = [4.0, 5.0, 2.0]
    state.ledger.replace("singles", singles)
    return problem_of(state)
