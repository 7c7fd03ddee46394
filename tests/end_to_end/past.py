"""The past: what happened when, and what is known of it now, beside what was shown then."""

from playwright.sync_api import Page


class PastCompared:
    """What is seen of it.

    Args:
        page: a page of the browser.
    """

    def __init__(self, page: Page) -> None:
        self.page = page

    def drags_the_handle(self, to: float) -> None:
        """Lead the timeline's handle with one finger from its right end to a share of its length."""
        handle = self.page.get_by_test_id("timeline").get_by_role("slider")
        box = handle.bounding_box()
        assert box is not None
        y = box["y"] + box["height"] / 2
        self.page.mouse.move(box["x"] + box["width"] - 8, y)
        self.page.mouse.down()
        for part in range(1, 11):
            self.page.mouse.move(box["x"] + box["width"] * (1 - part * (1 - to) / 10), y)
            self.page.wait_for_timeout(50)
        self.page.mouse.up()

    @property
    def handle_short_of_end_s(self) -> float:
        """How far before the end of the timeline its handle stands (s)."""
        handle = self.page.get_by_test_id("timeline").get_by_role("slider")
        return float(handle.evaluate("(handle) => Number(handle.max) - handle.valueAsNumber"))

    @property
    def asked(self) -> str:
        """The time that the handle stands for, as the timeline says it."""
        return self.page.get_by_test_id("asked").locator("span").first.inner_text()

    @property
    def other_day(self) -> str:
        """The day of what is shown, where the top bar names it; nothing for today."""
        said = self.page.get_by_test_id("day")
        return said.inner_text() if said.count() else ""

    @property
    def days_end_at(self) -> list[str]:
        """The days that begin on the timeline, each where a mark says so."""
        found: list[str] = self.page.get_by_test_id("timeline").evaluate(
            "(bar) => [...bar.querySelectorAll('.midnight')].map((mark) => mark.title)"
        )
        return found

    @property
    def was_set(self) -> list[str]:
        """What was set under way, each where a mark on the timeline says so, without its time."""
        found: list[str] = self.page.get_by_test_id("timeline").evaluate(
            "(bar) => [...bar.querySelectorAll('.set')].map((mark) => mark.title.replace(/^\\S+ /, ''))"
        )
        return found

    @property
    def not_the_end(self) -> str:
        """What is said of a closed incident whose end is not known yet; nothing where it is."""
        said = self.page.get_by_test_id("unfinished")
        return " ".join(said.inner_text().split()) if said.count() else ""

    @property
    def storeys(self) -> list[str]:
        """The names on the storey buttons."""
        return self.page.get_by_test_id("storeys").locator(".name").all_inner_texts()

    @property
    def asked_aloud(self) -> str:
        """The moment at which the timeline's handle stands, as it is read aloud."""
        slider = self.page.get_by_test_id("timeline").get_by_role("slider")
        return str(slider.get_attribute("aria-valuetext"))

    @property
    def play_button(self) -> str:
        """Play, where the replay stands; else Pause."""
        return self.page.get_by_test_id("play").inner_text()

    @property
    def event(self) -> str:
        """What the map says happened at the moment that is shown."""
        return " ".join(self.page.get_by_test_id("event").inner_text().split())

    @property
    def under_words_of_the_past(self) -> list[str]:
        """The buttons of the map, and the lines of the board, over which words of the past are written."""
        found: list[str] = self.page.evaluate(
            """() => {
              const words = [...document.querySelectorAll(
                '[data-testid=event] span, [data-testid=compare], [data-testid=compare-said]')];
              const over = (a, b) => a.left < b.right - 1 && b.left < a.right - 1
                && a.top < b.bottom - 1 && b.top < a.bottom - 1 && a.width * b.width > 0;
              return [...document.querySelectorAll(
                'nav.controls button, [data-testid=storeys] button, [data-testid=responder]'
              )].filter((part) =>
                  words.some((word) => over(word.getBoundingClientRect(), part.getBoundingClientRect())))
                .map((part) => part.getAttribute('aria-label') ?? part.textContent.trim());
            }"""
        )
        return found

    @property
    def can_compare(self) -> bool:
        """Whether there is a button that puts beside what is shown what is known now."""
        return self.page.get_by_test_id("compare").is_visible()

    def compares(self) -> None:
        """Press it."""
        self.page.get_by_test_id("compare").click()

    @property
    def words_of_the_comparison(self) -> str:
        """What is said of how to read it, or of what it waits for."""
        said = self.page.get_by_test_id("compare-said")
        return said.inner_text() if said.count() else ""

    @property
    def known_now(self) -> dict[str, str]:
        """How what is known now differs from what was shown, by callsign."""
        words: dict[str, str] = self.page.get_by_test_id("board").evaluate(
            """(board) => Object.fromEntries([...board.querySelectorAll('.known')].map((part) => {
              const name = part.closest('button').querySelector('.name');
              return [name.textContent.trim(), part.textContent.trim()];
            }))"""
        )
        return words
