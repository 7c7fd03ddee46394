"""The newest reading on each link."""

import numpy as np
import pytest

from estimator.fusion.learned.link_correlation import ALIKE, ERROR, KEPT, NEW, Links, follow


def test_a_link_forgets_its_error_once_an_end_has_walked_a_room_on() -> None:
    link = np.array(NEW)
    for second in range(10):
        follow(link, float(second), 0.0)
    assert link[ALIKE] == pytest.approx(10.0, rel=0.1)
    follow(link, 10.0, 30.0)
    assert link[ALIKE] == pytest.approx(1.0, abs=0.01)


def test_the_first_reading_on_a_link_shares_its_error_with_none() -> None:
    link = np.array(NEW)
    follow(link, 1.7e9, 40.0)
    assert link[ALIKE] == 1.0
    assert link[KEPT] == 0.0
    assert np.isnan(link[ERROR])


def test_a_link_is_the_same_in_either_direction_and_keeps_its_row_as_the_table_grows() -> None:
    links = Links()
    for name in range(40):
        assert links.number("uwb", "ff", f"b{name}") == name
        links.table[name, ERROR] = name
    assert links.number("uwb", "b7", "ff") == 7
    assert links.number("rtt", "b7", "ff") == 40
    assert links.table[:40, ERROR].tolist() == list(range(40))


def test_a_node_that_lies_elsewhere_has_other_errors_on_its_links_and_on_no_others() -> None:
    links = Links()
    for a, b in (("b1", "ff"), ("b1", "b2"), ("b2", "ff")):
        links.number("uwb", a, b)
    for link in links.table:
        follow(link, 5.0, 0.0)
    links.renew("b1")
    assert links.table[:, ALIKE].tolist() == [0.0, 0.0, 1.0]
    assert links.number("uwb", "ff", "b1") == 0


def test_a_copy_shares_nothing_that_changes() -> None:
    links = Links()
    links.number("uwb", "a", "b")
    twin = links.copy()
    follow(twin.table[0], 5.0, 0.0)
    twin.number("uwb", "a", "c")
    assert len(links.numbers) == 1
    assert links.table[0, ALIKE] == 0.0
