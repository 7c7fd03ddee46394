"""Records survive the way through the database and over the link."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.live.record import EMPTY, PictureRecord, RecordNode, UnknownRecord, decode, encode

numbers = st.floats(allow_nan=False, allow_infinity=False)


@given(st.lists(st.tuples(st.text(max_size=64), numbers, st.tuples(numbers, numbers, numbers)), max_size=5))
def test_a_record_comes_back_to_the_last_bit(
    nodes: list[tuple[str, float, tuple[float, float, float]]],
) -> None:
    record = PictureRecord(
        t=1.5,
        nodes=tuple(RecordNode(node=name, role="uav", t=t, position_m=place) for name, t, place in nodes),
    )
    assert decode(encode(record)) == record


def test_a_record_of_another_version_is_refused() -> None:
    with pytest.raises(UnknownRecord, match="version 250"):
        decode(b"\xfa" + encode(EMPTY)[1:])
    with pytest.raises(UnknownRecord):
        decode(b"")
