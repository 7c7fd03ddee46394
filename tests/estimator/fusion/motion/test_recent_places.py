"""Where a unit stood between the marks of its trail."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.motion.recent_places import between


@given(st.integers(0, 10_000), st.integers(2, 8))
def test_it_is_what_interpolation_gives(seed: int, m: int) -> None:
    chance = np.random.default_rng(seed)
    marks = np.column_stack([np.sort(chance.uniform(0.0, 9.0, m)), chance.normal(0.0, 5.0, (m, 3))])
    for t in (-1.0, 10.0, *marks[:, 0].tolist(), *chance.uniform(0.0, 9.0, 5).tolist()):
        expected = [float(np.interp(t, marks[:, 0], marks[:, axis])) for axis in (1, 2, 3)]
        assert between(marks, t) == pytest.approx(expected)
