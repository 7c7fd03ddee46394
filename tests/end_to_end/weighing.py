"""Why somebody is here: what is said while the whole log is weighed for it."""

import json
from urllib.parse import parse_qs, urlsplit

from playwright.sync_api import Page, Route

TOO_SLOW = {
    "type": "urn:firethread:problem:too-slow",
    "title": "What was waited for did not come in time",
    "status": 504,
    "detail": "Weighing takes longer than 60 s; it goes on, 60 s so far: ask again in a minute.",
}


class WhyAsked:
    """What is seen of it.

    Args:
        page: a page of the browser.

    Attributes:
        asked_about: the moments that evidence was asked of since `hears_that_it_takes_long`.
    """

    asked_about: list[str | None]

    def __init__(self, page: Page) -> None:
        self.page = page

    def hears_that_it_takes_long(self, times: int) -> None:
        """The next answers about evidence are those of a server whose sum is not done in time."""

        def answer(asked: Route) -> None:
            moment = parse_qs(urlsplit(asked.request.url).query).get("t", [None])[0]
            self.asked_about.append(moment)
            if len(self.asked_about) > times:
                asked.continue_()
            else:
                kind = "application/problem+json"
                asked.fulfill(status=504, content_type=kind, body=json.dumps(TOO_SLOW))

        self.page.route("**/evidence?*", answer)

    def begins_to_ask_why_here(self) -> None:
        """Press the card's question what holds the fix."""
        self.page.get_by_test_id("why").get_by_role("button", name="Why here?").click()

    def asks_why_here(self) -> None:
        """Press it, and wait for the answer."""
        self.begins_to_ask_why_here()
        self.page.get_by_test_id("held").wait_for(timeout=60_000)

    @property
    def weighed_so_far(self) -> str:
        """For how long an answer has been worked out, as it is said; nothing where none is."""
        said = self.page.get_by_test_id("so-far")
        return said.inner_text() if said.count() else ""

    @property
    def sees_that_it_is_weighed(self) -> bool:
        """Whether what is said of it lies wholly on the board, without a finger moving that."""
        said, board = (
            self.page.get_by_test_id("so-far").bounding_box(),
            self.page.get_by_test_id("board").bounding_box(),
        )
        assert said is not None
        assert board is not None
        return board["y"] <= said["y"] and said["y"] + said["height"] <= board["y"] + board["height"] + 1

    @property
    def answer_fills_the_card(self) -> bool:
        """Whether what holds the fix is as wide as the question and the card's way out together."""
        held, way_out = (
            self.page.get_by_test_id("held").bounding_box(),
            self.page.get_by_role("button", name="Close details").bounding_box(),
        )
        assert held is not None
        assert way_out is not None
        return abs(held["x"] + held["width"] - way_out["x"] - way_out["width"]) < 2

    def is_told_what_holds(self) -> bool:
        """Whether the evidence is there."""
        return self.page.get_by_test_id("held").is_visible()
