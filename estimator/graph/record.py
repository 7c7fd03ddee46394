"""Arrays as plain values, for snapshots: exact to the last bit."""

import numpy as np

from estimator.graph.dense import Array

ArrayRecord = tuple[list[int], bytes]
"""Shape, and content in C order."""


def pack(array: Array) -> ArrayRecord:
    """An array of any shape as plain values; it shares nothing with the array."""
    return list(array.shape), array.tobytes()


def unpack(record: ArrayRecord) -> Array:
    """The array that `pack` was given, new and writable.

    Raises:
        ValueError: the content does not fill the shape.
    """
    shape, content = record
    array: Array = np.frombuffer(content, dtype=np.float64).reshape(shape).copy()
    return array
