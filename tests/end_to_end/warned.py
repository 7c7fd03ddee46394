"""What the commander is warned of: calls, low air, who is heard and not followed, what went wrong."""

from playwright.sync_api import Page


class WarningsSeen:
    """What is seen of warnings.

    Args:
        page: a page of the browser.
    """

    def __init__(self, page: Page) -> None:
        self.page = page

    @property
    def trouble(self) -> str:
        """What the top bar says went wrong; nothing if nothing did."""
        said = self.page.locator("header [role=status]")
        return said.inner_text() if said.count() else ""

    @property
    def low_on_air(self) -> list[str]:
        """Who is low on air: name, pressure and age, one text each."""
        found = self.page.get_by_test_id("low-on-air").all_inner_texts()
        return [" ".join(text.split()) for text in found]

    @property
    def low_air_heading(self) -> str:
        """What stands before the names."""
        return self.page.get_by_test_id("low-air-strip").get_by_role("heading").inner_text()

    @property
    def told_out_of_sight(self) -> list[str]:
        """Which are not seen: the first call here, the first low on air, the first call elsewhere."""
        found: list[str] = self.page.evaluate(
            """() => ['alarm', 'low-on-air', 'call-elsewhere'].filter((what) => {
              const told = document.querySelector(`[data-testid=${what}]`);
              const button = told.matches('button') ? told : told.querySelector('button');
              const {left, right, top, bottom} = button.getBoundingClientRect();
              return ![top + 8, bottom - 8].every((y) =>
                button.contains(document.elementFromPoint((left + right) / 2, y)));
            })"""
        )
        return found

    @property
    def calls_half_seen(self) -> list[str]:
        """Which calls are not seen whole: who it is, a first line of what is said, the button."""
        found: list[str] = self.page.get_by_test_id("alarms").evaluate(
            """(alarms) => {
              const {top, bottom} = alarms.firstElementChild.getBoundingClientRect();
              const whole = (part, height) => {
                const box = part.getBoundingClientRect();
                return box.top >= top - 1 && Math.min(box.bottom, box.top + height) <= bottom + 1;
              };
              return [...alarms.querySelectorAll('[data-testid=alarm]')].filter((call) => {
                const words = call.querySelector('p');
                return !whole(call.querySelector('.who'), 1000) || !whole(call.querySelector('.act'), 1000)
                  || words !== null && !whole(words, 20);
              }).map((call) => call.querySelector('.who').dataset.call);
            }"""
        )
        return found

    @property
    def alarm_answers(self) -> str:
        """What the button of the first alarm says, once a finger may press it; nothing until then."""
        button = self.page.get_by_test_id("alarm").first.locator(".act:enabled")
        return button.inner_text() if button.count() else ""

    def words_said_whole(self, caller: int) -> bool:
        """Whether nothing that a caller says, counted from the top, is left out in the alarm itself."""
        words = self.page.get_by_test_id("alarm").nth(caller).locator("p")
        return bool(words.evaluate("(words) => words.scrollHeight <= words.clientHeight + 1"))

    @property
    def low_air_is_loud(self) -> bool:
        """Whether the strip that says so has the colour of a warning."""
        strip = self.page.get_by_test_id("low-air-strip")
        return bool(strip.count()) and bool(
            strip.evaluate(
                """(strip) => {
                  const probe = document.createElement('i');
                  probe.style.color = 'var(--warn)';
                  strip.append(probe);
                  const warning = getComputedStyle(probe).color;
                  probe.remove();
                  return getComputedStyle(strip).backgroundColor === warning;
                }"""
            )
        )

    @property
    def spoken_of_air(self) -> str:
        """What a screen reader is told of low air."""
        return self.page.get_by_test_id("low-air").get_by_role("status").inner_text().strip()

    def has_seen_the_low_air(self) -> None:
        """Press that it was seen."""
        self.page.get_by_test_id("low-air").get_by_role("button", name="Seen").click()

    def goes_to_who_is_low_on_air(self) -> None:
        """Tap the first one."""
        self.page.get_by_test_id("low-on-air").first.click()

    @property
    def low_air_too_small_for_gloves(self) -> list[str]:
        """The buttons of the strip that are lower or narrower than 44 px."""
        found: list[str] = self.page.get_by_test_id("low-air").evaluate(
            """(part) => [...part.querySelectorAll('button')].filter((button) => {
              const {width, height} = button.getBoundingClientRect();
              return Math.min(width, height) < 44;
            }).map((button) => button.textContent.trim())"""
        )
        return found

    @property
    def not_followed(self) -> list[str]:
        """Who is heard and not followed on the map, and why, one text for each reason."""
        found = self.page.get_by_test_id("not-followed").locator("li").all_inner_texts()
        return [" ".join(text.split()) for text in found]

    @property
    def fallen_silent(self) -> list[str]:
        """What is said of those of whom nobody is heard."""
        return [" ".join(text.split()) for text in self.page.get_by_test_id("silence").all_inner_texts()]

    @property
    def clocks_behind(self) -> str:
        """What is said of clocks that are behind; nothing where none is."""
        said = self.page.get_by_test_id("clocks-behind")
        return " ".join(said.inner_text().split()) if said.count() else ""

    @property
    def not_followed_in_view(self) -> bool:
        """Whether that is seen, however far the board is turned."""
        said, board = (
            self.page.get_by_test_id("not-followed").bounding_box(),
            self.page.get_by_test_id("board").bounding_box(),
        )
        return (
            said is not None
            and board is not None
            and board["y"] <= said["y"] < board["y"] + board["height"] / 2
        )

    @property
    def advice(self) -> str:
        """What is advised to make a fix surer; nothing where nothing is."""
        said = self.page.get_by_test_id("advice")
        return said.inner_text() if said.count() else ""
