"""Two fingers move the map as they move, and nobody gets lost under them."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from tests.end_to_end.canvas import FIRST_CREW, SECOND_CREW
from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import base, heard, responder
from tests.running import Post, Server, eventually

T0 = 1_763_712_345.0


@pytest.fixture
def at_a_tablet(browser: Browser, server: Server, post: Post) -> Iterator[Commander]:
    """A commander whose screen takes touches, with two crews five metres apart on it."""
    incident = post.open_incident()
    crews = responder(T0, "ff1", "A", [-2.5, 0, 0]), responder(T0, "ff2", "B", [2.5, 0, 0])
    heard(post, incident, base(T0), *crews)
    context = browser.new_context(viewport={"width": 1024, "height": 768}, has_touch=True)
    commander = Commander(context.new_page())
    commander.opens(server.url, incident)
    yield commander
    context.close()
    assert commander.faults == []


def test_two_fingers_apart_enlarge_the_map_and_side_by_side_they_move_it(at_a_tablet: Commander) -> None:
    def marks() -> list[tuple[float, float]]:
        return [(mark.x, mark.y) for mark in map(at_a_tablet.settled_mark, (FIRST_CREW, SECOND_CREW))]

    (west, _), (east, _) = marks()
    at_a_tablet.pinches(370, 350, apart_px=100, to_px=200)
    (wider_west, y), (wider_east, _) = marks()
    assert wider_east - wider_west == pytest.approx(2 * (east - west), rel=0.05)
    at_a_tablet.leads_two_fingers([(320, 350), (420, 350)], [(370, 380), (470, 380)])
    assert marks() == [pytest.approx((x + 50, y + 30), abs=3) for x in (wider_west, wider_east)]
    assert at_a_tablet.page_enlarged == 1


def test_who_has_enlarged_the_page_unawares_gets_back_from_the_map_alone(at_a_tablet: Commander) -> None:
    at_a_tablet.pinches(250, 22, apart_px=100, to_px=300)
    eventually(lambda: at_a_tablet.page_enlarged > 1.5)
    at_a_tablet.pinches(370, 350, apart_px=300, to_px=40)
    eventually(lambda: at_a_tablet.page_enlarged == 1)
