"""Fingers on the screen of a tablet."""

from playwright.sync_api import Page

Places = list[tuple[float, float]]


class FingersUsed:
    """What they do; the browser must be one of a screen that takes touches.

    Args:
        page: a page of the browser.
    """

    def __init__(self, page: Page) -> None:
        self.page = page

    def leads_two_fingers(self, start: Places, end: Places) -> None:
        """Put two fingers down, lead each on a straight line, and lift them."""
        devtools = self.page.context.new_cdp_session(self.page)
        for step in range(11):
            points = [
                {"x": x + (to_x - x) * step / 10, "y": y + (to_y - y) * step / 10, "id": finger}
                for finger, ((x, y), (to_x, to_y)) in enumerate(zip(start, end, strict=True))
            ]
            kind = "touchMove" if step else "touchStart"
            devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        devtools.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    def pinches(self, x: float, y: float, apart_px: float, to_px: float) -> None:
        """Lead two fingers about a place from one distance to another."""
        halves = apart_px / 2, to_px / 2
        start, end = ([(x - half, y), (x + half, y)] for half in halves)
        self.leads_two_fingers(start, end)

    @property
    def page_enlarged(self) -> float:
        """How many times its size the page has under the fingers."""
        return float(self.page.evaluate("window.visualViewport.scale"))

    def taps_again_and_again(self, name: str) -> None:
        """Tap a button of the first alarm, and for half a second what has taken its place."""
        button = self.page.get_by_test_id("alarm").first.get_by_role("button", name=name, exact=True)
        box = button.bounding_box()
        assert box is not None
        place = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.click(*place)
        button.wait_for(state="detached")
        for _ in range(4):
            self.page.mouse.click(*place)
            self.page.wait_for_timeout(120)
