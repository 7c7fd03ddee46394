"""Paper A's system takes the readings of a batch in any order, and accounts for each."""

from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.measurements import AnyReading
from tests.estimator.arbitrary import readings
from tests.estimator.paper_a.folding import folded
from tests.estimator.walks import two_responders


def test_readings_of_one_batch_may_stand_in_any_order() -> None:
    walk = two_responders(50)
    by_name = {e.node: e for e in folded(walk).estimates()}
    assert {e.node: e for e in folded(walk[::-1]).estimates()} == by_name


@settings(max_examples=100, deadline=None)
@given(st.lists(st.lists(readings, max_size=12), max_size=8))
def test_every_reading_is_counted_once(batches: list[list[AnyReading]]) -> None:
    counts = folded(*batches).counts()
    assert counts["received"] == sum(number for what, number in counts.items() if what != "received")
