"""What the commander is told of incidents that are not on the screen, and the way there and back."""

from playwright.sync_api import Page


class OthersSeen:
    """What is seen of other incidents.

    Args:
        page: a page of the browser.
    """

    def __init__(self, page: Page) -> None:
        self.page = page

    @property
    def incident_begun(self) -> str:
        """Whether the incident that is chosen is closed, and when it was begun, under its name."""
        return self.page.get_by_test_id("incident-begun").inner_text()

    @property
    def name_and_begin_overlap(self) -> bool:
        """Whether when the incident was begun lies over its name, or is cut."""
        fits: bool = self.page.get_by_test_id("incident-begun").evaluate(
            """(begun) => {
              const select = begun.parentElement.querySelector('select');
              const [box, around] = [begun.getBoundingClientRect(), select.getBoundingClientRect()];
              const nameEnds = around.bottom - parseFloat(getComputedStyle(select).paddingBottom);
              return begun.scrollWidth <= begun.clientWidth + 1 && box.top >= nameEnds - 4
                && box.bottom <= around.bottom;
            }"""
        )
        return not fits

    @property
    def calls_elsewhere(self) -> list[str]:
        """What is said of calls for help in other incidents, one text an incident."""
        return [
            " ".join(text.split()) for text in self.page.get_by_test_id("call-elsewhere").all_inner_texts()
        ]

    @property
    def words_of_elsewhere(self) -> str:
        """Everything that is seen of other incidents."""
        return " ".join(self.page.get_by_test_id("elsewhere").inner_text().split())

    @property
    def spoken_of_elsewhere(self) -> str:
        """What a screen reader is told of other incidents."""
        return " ".join(self.page.get_by_test_id("elsewhere").get_by_role("alert").inner_text().split())

    def goes_to_the_call_elsewhere(self) -> None:
        """Tap the first call in another incident."""
        self.page.get_by_test_id("call-elsewhere").first.click()

    @property
    def way_back(self) -> str:
        """The words on the button that leads back to where a call has led away from; nothing without one."""
        back = self.page.get_by_test_id("way-back")
        return " ".join(back.inner_text().split()) if back.count() else ""

    def takes_the_way_back(self) -> None:
        """Tap that button."""
        self.page.get_by_test_id("way-back").click()

    @property
    def marked_in_the_list(self) -> list[str]:
        """The incidents of the list that are marked with a call: the call and the incident's name."""
        options = self.page.get_by_test_id("incident-chooser").locator("option").all_inner_texts()
        parts = [option.strip().split(" · ") for option in options]
        return [" ".join(words[:2]) for words in parts if words[0] in {"MAYDAY", "PASS", "HELP"}]

    def cannot_see_other_incidents(self, *, cut_off: bool) -> None:
        """Let requests for the list of active incidents fail, or no longer."""
        if cut_off:
            self.page.route("**/api/v1/incidents?state=active", lambda route: route.abort())
        else:
            self.page.unroute("**/api/v1/incidents?state=active")

    @property
    def silence_elsewhere(self) -> str:
        """What is said of other incidents that are not heard; nothing while they are."""
        said = self.page.get_by_test_id("elsewhere-silent")
        return said.inner_text() if said.count() else ""

    def too_small_for_gloves(self, least_px: float) -> list[str]:
        """The buttons about other incidents that are lower or narrower than that."""
        found: list[str] = self.page.get_by_test_id("elsewhere").evaluate(
            """(part, least) => [...part.querySelectorAll('button')].filter((button) => {
              const {width, height} = button.getBoundingClientRect();
              return Math.min(width, height) < least;
            }).map((button) => button.textContent.trim())""",
            least_px,
        )
        return found
