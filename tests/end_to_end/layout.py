"""How the page lies before the commander's eyes and under the fingers: sizes, rows, what does not fit."""

from playwright.sync_api import Page


class LayoutSeen:
    """What is seen of the page's layout.

    Args:
        page: a page of the browser.
    """

    def __init__(self, page: Page) -> None:
        self.page = page

    def cut_off(self) -> list[str]:
        """The texts on the board that do not fit where they stand."""
        found: list[str] = self.page.evaluate(
            """() => [...document.querySelectorAll('[data-testid=responder]')].flatMap((row) =>
              [...row.querySelectorAll('span')].filter((part) => !part.closest('.unseen') && (
                part.scrollWidth > part.clientWidth + 1 && getComputedStyle(part).overflowX !== 'visible'
                || part.getBoundingClientRect().right > row.getBoundingClientRect().right + 1
                || part.matches('.name') && part.nextElementSibling.getBoundingClientRect().left
                   < part.getBoundingClientRect().left + part.scrollWidth - 1)
              ).map((part) => part.textContent.trim()))"""
        )
        return found

    def sits_at(self, width: int, height: int) -> None:
        """Use a screen of another size (CSS pixels)."""
        self.page.set_viewport_size({"width": width, "height": height})

    def sits_at_a_tablet(self) -> None:
        """Use a screen of 1024 x 768."""
        self.sits_at(1024, 768)

    @property
    def timeline_rows(self) -> int:
        """In how many rows the timeline's buttons lie."""
        tops: list[float] = self.page.get_by_test_id("timeline").evaluate(
            """(bar) => [...bar.querySelectorAll('button, select')]
              .map((one) => one.getBoundingClientRect().top)"""
        )
        return len({round(top) for top in tops})

    @property
    def timeline_overlaps(self) -> list[str]:
        """Parts of the timeline's row that lie over one another or do not fit their own box."""
        found: list[str] = self.page.get_by_test_id("timeline").evaluate(
            """(bar) => {
              const parts = [...bar.querySelectorAll('button, select, .when')];
              const boxes = parts.map((part) => part.getBoundingClientRect());
              return parts.filter((part, at) => part.scrollWidth > part.clientWidth + 1
                || part.scrollHeight > part.clientHeight + 1
                || at > 0 && boxes[at].left < boxes[at - 1].right - 1).map((part) => part.textContent.trim());
            }"""
        )
        return found

    @property
    def off_the_screen(self) -> list[str]:
        """What reaches beyond the right edge of the screen."""
        found: list[str] = self.page.evaluate(
            """() => [...document.querySelectorAll('#app *')].filter((part) => !part.closest('.unseen')
              && part.getBoundingClientRect().right > document.documentElement.clientWidth + 1)
              .map((part) => `${part.tagName} ${part.className} ${part.textContent.trim().slice(0, 30)}`)"""
        )
        wide = self.page.evaluate(
            "document.scrollingElement.scrollWidth - document.scrollingElement.clientWidth"
        )
        return found + ([f"the page is {wide} px too wide"] if wide > 0 else [])

    @property
    def map_height(self) -> float:
        """How high the map is (CSS pixels)."""
        box = self.page.get_by_test_id("map").bounding_box()
        assert box is not None
        return box["height"]

    @property
    def card_left(self) -> float:
        """Where the card begins (CSS pixels from the left of the map)."""
        card = self.page.get_by_test_id("card").bounding_box()
        assert card is not None
        map_box = self.page.get_by_test_id("map").bounding_box()
        assert map_box is not None
        return card["x"] - map_box["x"]
