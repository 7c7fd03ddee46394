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

    @property
    def text_px(self) -> dict[str, float]:
        """How large text is (CSS pixels): names on the board, the clock of the top bar, and the rest."""
        sizes: dict[str, float] = self.page.evaluate(
            """() => Object.fromEntries(Object.entries(
                 {board: '[data-testid=responder] .name', clock: '[data-testid=clock] time', page: 'body'}
               ).map(([what, where]) =>
                 [what, parseFloat(getComputedStyle(document.querySelector(where)).fontSize)]))"""
        )
        return sizes

    @property
    def narrowest_name(self) -> float:
        """The room of the name that has the least on the board (CSS pixels)."""
        widths: list[float] = self.page.get_by_test_id("board").evaluate(
            "(board) => [...board.querySelectorAll('.name')].map((name) => name.clientWidth)"
        )
        return min(widths)

    @property
    def name_ends_seen(self) -> list[str]:
        """The last letters of each long name that gives way on the board, where they are wholly seen."""
        found: list[str] = self.page.get_by_test_id("board").evaluate(
            """(board) => [...board.querySelectorAll('.name.parts')].flatMap((name) => {
              const [room, end] = [name, name.lastElementChild].map((one) => one.getBoundingClientRect());
              const seen = end.width > 0 && end.right <= room.right + 1 && end.bottom <= room.bottom + 1;
              return seen ? [name.lastElementChild.textContent] : [];
            })"""
        )
        return found

    @property
    def calls_not_in_view(self) -> str:
        """What is said of calls that the list of alarms has no room for; nothing while all are seen."""
        said = self.page.get_by_test_id("alarms-unseen")
        return said.inner_text() if said.count() else ""

    def looks_at_calls_not_in_view(self) -> None:
        """Press that."""
        self.page.get_by_test_id("alarms-unseen").click()

    @property
    def storeys_out_of_sight(self) -> list[str]:
        """The storey buttons that are not wholly seen without scrolling."""
        found: list[str] = self.page.get_by_test_id("storeys").evaluate(
            """(bar) => {
              const room = bar.getBoundingClientRect();
              return [...bar.querySelectorAll('button')].filter((button) => {
                const {left, top, right, bottom} = button.getBoundingClientRect();
                return left < room.left - 1 || right > room.right + 1
                  || top < room.top - 1 || bottom > room.bottom + 1;
              }).map((button) => button.textContent.trim());
            }"""
        )
        return found

    def asks_for_the_empty_storeys(self) -> None:
        """Press the button that shows and hides storeys on which nobody is."""
        self.page.get_by_test_id("empty-storeys").click()

    @property
    def storeys_end(self) -> float:
        """How far the storey buttons reach into the map from its left edge (CSS pixels)."""
        bar, seen = (
            self.page.get_by_test_id("storeys").bounding_box(),
            self.page.get_by_test_id("map").bounding_box(),
        )
        assert bar is not None
        assert seen is not None
        return bar["x"] + bar["width"] - seen["x"]

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
            """(bar) => [...bar.querySelectorAll('button, select')].map((one) => one.getBoundingClientRect())
              .filter(({height}) => height > 0).map(({top}) => top)"""
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
    def top_bar_height(self) -> float:
        """How high the top bar is (CSS pixels): one row of buttons is 44 px and its edges."""
        box = self.page.locator("header").bounding_box()
        assert box is not None
        return box["height"]

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
    def slides_sideways(self) -> list[str]:
        """What holds more than it is wide, and would be pushed to and fro."""
        found: list[str] = self.page.evaluate(
            """() => [...document.querySelectorAll('#app *')].filter((part) => !part.closest('.unseen')
              && ['auto', 'scroll'].includes(getComputedStyle(part).overflowX)
              && part.scrollWidth > part.clientWidth + 1)
              .map((part) => `${part.tagName} ${part.className}`)"""
        )
        return found

    def scrolls_to_the_end(self) -> bool:
        """Turn the wheel over the top bar as far as it goes; whether the whole timeline is seen then."""
        self.page.mouse.move(5, 5)
        self.page.mouse.wheel(0, 10_000)
        self.page.wait_for_timeout(500)
        box = self.page.get_by_test_id("timeline").bounding_box()
        height: float = self.page.evaluate("window.innerHeight")
        return box is not None and box["y"] >= 0 and box["y"] + box["height"] <= height + 1

    def closes_the_card(self) -> None:
        """Tap the card's way out, which must lie on the card."""
        button = self.page.get_by_role("button", name="Close details")
        card, way_out = self.page.get_by_test_id("card").bounding_box(), button.bounding_box()
        assert card is not None
        assert way_out is not None
        assert way_out["x"] + way_out["width"] <= card["x"] + card["width"]
        button.click()

    @property
    def cut_off_counts(self) -> list[str]:
        """How many are live, stale, lost, as far as it lies under something or beyond the edge of its row."""
        found: list[str] = self.page.get_by_test_id("counts").evaluate(
            """(counts) => {
              const beside = counts.parentElement.querySelector(':scope > button').getBoundingClientRect();
              return [...counts.children].filter((part) => getComputedStyle(part).position !== 'absolute'
                && part.getBoundingClientRect().right > beside.left).map((part) => part.textContent);
            }"""
        )
        return found

    @property
    def too_small_on_a_phone(self) -> list[str]:
        """What is pressed and is lower or narrower than 44 px, sliders and what is not shown excepted."""
        found: list[str] = self.page.evaluate(
            """() => [...document.querySelectorAll('button, select')].filter((part) => {
              const {width, height} = part.getBoundingClientRect();
              return height > 0 && Math.min(width, height) < 43.5;
            }).map((part) => part.textContent.trim().slice(0, 30))"""
        )
        return found

    @property
    def words_are_under_the_caller(self) -> bool:
        """Whether what the first alarm says begins under who calls, at the left edge of the alarm."""
        under: bool = self.page.get_by_test_id("alarm").first.evaluate(
            """(alarm) => {
              const box = (part) => alarm.querySelector(part).getBoundingClientRect();
              const [who, words] = [box('.who'), box('p')];
              const seen = Math.max(...[...alarm.querySelectorAll('.who > *')].map(
                (part) => part.getBoundingClientRect().bottom));
              return words.top >= Math.max(who.bottom, seen) - 1 && Math.abs(words.left - who.left) < 2;
            }"""
        )
        return under

    @property
    def caller_is_clear_of_the_button(self) -> bool:
        """Whether nothing of who the first alarm is of lies under the button that answers it."""
        clear: bool = self.page.get_by_test_id("alarm").first.evaluate(
            """(alarm) => {
              const {left} = alarm.querySelector('.act').getBoundingClientRect();
              return [...alarm.querySelectorAll('.who strong')].every(
                (part) => part.getBoundingClientRect().right <= left);
            }"""
        )
        return clear

    @property
    def help_begins_at_its_head(self) -> bool:
        """Whether the head of the help sheet is seen without scrolling."""
        head = self.page.get_by_role("dialog").get_by_role("heading").bounding_box()
        return head is not None and head["y"] >= 0

    @property
    def reads_help(self) -> bool:
        """Whether the help sheet lies over everything."""
        return self.page.get_by_role("dialog").is_visible()

    @property
    def slid_px(self) -> float:
        """How far the page has slid up from where it belongs (CSS pixels)."""
        top: float = self.page.evaluate("document.querySelector('header').getBoundingClientRect().top")
        return -top

    @property
    def map_answers_under_the_storeys(self) -> bool:
        """Whether a finger well under the last storey button is on the map."""
        last = self.page.get_by_test_id("storeys").get_by_role("button").last.bounding_box()
        assert last is not None
        under = [last["x"] + last["width"] / 2, last["y"] + last["height"] + 40]
        found = self.page.evaluate("([x, y]) => document.elementFromPoint(x, y).tagName", under)
        return bool(found == "CANVAS")

    @property
    def map_height(self) -> float:
        """How high the map is (CSS pixels)."""
        box = self.page.get_by_test_id("map").bounding_box()
        assert box is not None
        return box["height"]

    @property
    def map_width(self) -> float:
        """How wide the map is (CSS pixels)."""
        box = self.page.get_by_test_id("map").bounding_box()
        assert box is not None
        return box["width"]

    def is_on_the_board(self, node: str) -> bool:
        """Whether the whole line of a responder is seen without turning the board."""
        line, board = (
            self.page.locator(f'[data-testid=responder][data-node="{node}"]').bounding_box(),
            self.page.get_by_test_id("board").bounding_box(),
        )
        assert line is not None
        assert board is not None
        return board["y"] - 1 <= line["y"] and line["y"] + line["height"] <= board["y"] + board["height"] + 1

    @property
    def card_on_the_map(self) -> bool:
        """Whether the card hides a part of the map."""
        card, seen = (
            self.page.get_by_test_id("card").bounding_box(),
            self.page.get_by_test_id("map").bounding_box(),
        )
        assert card is not None
        assert seen is not None
        return (
            card["x"] < seen["x"] + seen["width"]
            and seen["x"] < card["x"] + card["width"]
            and card["y"] < seen["y"] + seen["height"]
            and seen["y"] < card["y"] + card["height"]
        )
