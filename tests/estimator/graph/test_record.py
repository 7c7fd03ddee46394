"""Arrays in snapshots."""

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.graph.record import pack, unpack


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((0, 3)),
        np.array([-0.0, np.nan, np.inf, 5e-324]),
        np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        np.arange(12.0).reshape(3, 4)[:, ::2],
    ],
)
def test_an_array_comes_back_to_the_last_bit_and_may_be_changed(array: Array) -> None:
    found = unpack(pack(array))
    assert (found.shape, found.dtype, found.tobytes()) == (array.shape, array.dtype, array.tobytes())
    assert found.flags.writeable


def test_content_that_does_not_fill_its_shape_is_refused() -> None:
    with pytest.raises(ValueError, match="reshape"):
        unpack(([2, 2], np.zeros(3).tobytes()))
