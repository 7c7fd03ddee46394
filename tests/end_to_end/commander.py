"""The commander before the screen: with the parts it is made of, alone in knowing the page."""

import json
import re
import time
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote, urlencode

from playwright.sync_api import Locator, Page, WebSocketRoute

from tests.end_to_end.canvas import MapSeen
from tests.end_to_end.device import DeviceUsed
from tests.end_to_end.layout import LayoutSeen
from tests.end_to_end.letting_in import SignInSeen
from tests.end_to_end.noting import BoardNoted
from tests.end_to_end.others import OthersSeen
from tests.end_to_end.past import PastCompared
from tests.end_to_end.warned import WarningsSeen
from tests.end_to_end.weighing import WhyAsked
from tests.running import eventually


@dataclass(frozen=True)
class BoardRow:
    """One line of the accountability board."""

    status: str
    age_s: float
    level: str
    error: str
    air: str


class Commander(
    MapSeen, LayoutSeen, OthersSeen, PastCompared, SignInSeen, DeviceUsed, BoardNoted, WarningsSeen, WhyAsked
):
    """What a commander sees and does.

    Args:
        page: a fresh page of the browser.
    """

    def __init__(self, page: Page) -> None:
        super().__init__(page)
        self.requested: list[str] = []
        self.faults: list[str] = []
        self.asked_about = []
        page.on("request", lambda request: self.requested.append(request.url))
        page.on("websocket", lambda socket: self.requested.append(socket.url))
        page.on("pageerror", lambda error: self.faults.append(str(error)))

    def opens(self, url: str, incident: str) -> float:
        """Open the screen on an incident; seconds until the first responder was on the board."""
        began = time.monotonic()
        self.page.goto(f"{url}/#incident={quote(incident)}")
        self.page.get_by_test_id("responder").first.wait_for()
        return time.monotonic() - began

    def follows_link(self, url: str, incident: str, **what: str | float) -> None:
        """Open the screen by a link to what is in an incident: `node`, `level`, `t`."""
        fields = {"incident": incident, **what}
        self.page.goto(f"{url}/#{urlencode(fields)}")
        self.page.get_by_test_id("responder").first.wait_for()

    def reloads(self) -> None:
        """Load the page again."""
        self.page.reload()
        self.page.get_by_test_id("responder").first.wait_for()

    @property
    def incident(self) -> str:
        """The name of the incident that is chosen."""
        chosen = self.page.get_by_test_id("incident-chooser").locator("option:checked").inner_text()
        return chosen.split(" · ")[0].strip()

    def chooses_incident(self, name: str) -> None:
        """Choose another incident; of those with the same name the newest."""
        chooser = self.page.get_by_test_id("incident-chooser")
        wanted = chooser.locator("option").filter(has_text=name).first.get_attribute("value")
        chooser.select_option(wanted)

    def board(self) -> dict[str, BoardRow]:
        """The accountability board: callsign to status word, age, level and error."""
        rows: dict[str, list[str]] = self.page.evaluate(
            """() => Object.fromEntries([...document.querySelectorAll('[data-testid=responder]')].map(row => {
              const of = (id) => row.querySelector(`[data-testid=${id}]`)?.textContent.trim() ?? '';
              return [row.querySelector('.name').textContent.trim(),
                      [of('status'), of('age'), of('level'), of('error'), of('air')]];
            }))"""
        )
        return {
            name: BoardRow(status, _seconds(age), level, error, air)
            for name, (status, age, level, error, air) in rows.items()
        }

    @property
    def board_words(self) -> str:
        """Everything on the board."""
        return " ".join(self.page.get_by_test_id("board").inner_text().split())

    def sees(self, name: str, status: str, within_s: float = 15.0) -> None:
        """Wait until the board gives a responder that status."""
        eventually(lambda: name in (rows := self.board()) and rows[name].status == status, within_s)

    def selects(self, node: str) -> None:
        """Press a responder's line on the board."""
        self.page.locator(f'[data-testid=responder][data-node="{node}"]').click()

    @property
    def selected(self) -> str | None:
        """The node whose line is pressed."""
        line = self.page.locator('[data-testid=responder][aria-pressed="true"]')
        return line.get_attribute("data-node") if line.count() else None

    @property
    def card(self) -> str:
        """The text of the selected responder's card, nothing if there is none."""
        card = self.page.get_by_test_id("card")
        return card.inner_text() if card.count() else ""

    def chooses_storey(self, name: str) -> None:
        """Press a storey's button."""
        self.page.get_by_test_id("storeys").get_by_role(
            "button", name=re.compile(f"^{re.escape(name)}")
        ).click()

    @property
    def storey(self) -> str:
        """The name on the storey button that is pressed."""
        return self.page.get_by_test_id("storeys").locator('[aria-pressed="true"] .name').inner_text()

    @property
    def counts(self) -> str:
        """How many responders there are, live, stale, lost, as the top bar says it."""
        return " ".join(self.page.get_by_test_id("counts").inner_text().split())

    def shows_the_next(self, status: str) -> None:
        """Press how many are stale, or lost, in the top bar."""
        self.page.get_by_test_id("counts").get_by_role("button", name=re.compile(status)).click()

    @property
    def banners(self) -> list[str]:
        """The texts of the alarm banners."""
        return [" ".join(text.split()) for text in self.page.get_by_test_id("alarm").all_inner_texts()]

    @property
    def alarm_words(self) -> str:
        """Everything said of alarms, also of what could not be sent."""
        return " ".join(self.page.get_by_test_id("alarms").inner_text().split())

    def goes_to_the_alarm(self) -> None:
        """Press the first alarm's banner beside its buttons."""
        self.page.get_by_test_id("alarm").first.get_by_role("button").first.click()

    def acknowledges(self) -> None:
        """Acknowledge the first alarm."""
        self._alarm_button("Acknowledge").click()

    def clears(self) -> None:
        """Clear the first alarm."""
        self._alarm_button("Clear").click()

    def _alarm_button(self, name: str) -> Locator:
        return self.page.get_by_test_id("alarm").first.get_by_role("button", name=name, exact=True)

    @property
    def connection_lost(self) -> bool:
        """Whether the sign of the lost connection is shown."""
        return self.page.get_by_test_id("connection-lost").is_visible()

    @property
    def stands_still(self) -> bool:
        """Whether it is said that the estimator could not go on."""
        return self.page.get_by_test_id("stands-still").is_visible()

    @property
    def is_behind(self) -> bool:
        """Whether it is said that the picture lacks what was last reported."""
        return self.page.get_by_test_id("behind").is_visible()

    def hears_that_the_estimator_broke(self) -> None:
        """From the next page on every picture comes with the notice that the server adds when it broke."""
        broke = {"code": "estimator_failed", "t": 0.0, "text": "It broke.", "node": None}

        def told(here: WebSocketRoute) -> None:
            server = here.connect_to_server()

            def hand_on(message: str | bytes) -> None:
                said = json.loads(message)
                if "notices" in said:
                    said["notices"].append(broke)
                here.send(json.dumps(said))

            server.on_message(hand_on)

        self.page.route_web_socket(re.compile("/live"), told)

    @property
    def mode(self) -> str:
        """LIVE, RECORDED, REPLAY, CLOSED, or NOT LIVE."""
        return self.page.get_by_test_id("clock").locator(".mode").inner_text()

    @property
    def clock(self) -> str:
        """The time that the picture stands for, as the top bar says it."""
        return self.page.get_by_test_id("clock").locator("time").inner_text()

    def scrubs_to(self, t: float) -> None:
        """Drag the timeline's handle to a moment (Unix s)."""
        self.page.get_by_test_id("timeline").get_by_role("slider").evaluate(
            """(slider, t) => {
              slider.valueAsNumber = t;
              slider.dispatchEvent(new Event('input', {bubbles: true}));
            }""",
            t,
        )

    def plays(self) -> None:
        """Press play, or pause."""
        self.page.get_by_test_id("play").click()

    @property
    def newest_button(self) -> str:
        """The words on the button back to live."""
        return self.page.get_by_test_id("back-to-live").inner_text()

    @property
    def event_marks(self) -> list[str]:
        """The words of the marks on the timeline, in their order."""
        marks: list[str] = self.page.get_by_test_id("timeline").evaluate(
            """(bar) => [...bar.querySelectorAll('i:not(.midnight)')].map(
                 ({title}) => title.replace(/^\\S+ /, ''))"""
        )
        return marks

    @property
    def events_either_way(self) -> tuple[bool, bool]:
        """Whether the timeline leads to an event before, and to one after."""
        return self._event_button("Previous event").is_enabled(), self._event_button(
            "Next event"
        ).is_enabled()

    def goes_to_the_next_event(self) -> None:
        """Press the arrow to the next mark on the timeline."""
        self._event_button("Next event").click()

    def _event_button(self, name: str) -> Locator:
        return self.page.get_by_test_id("timeline").get_by_role("button", name=name)

    def goes_back_to_live(self) -> None:
        """Press the button back to live."""
        self.page.get_by_test_id("back-to-live").click()

    def presses(self, key: str) -> None:
        """Press a key."""
        self.page.keyboard.press(key)

    def turns_trails_off(self) -> None:
        """Choose no trails."""
        self.page.get_by_label("Trail").select_option("0")

    @property
    def theme(self) -> str:
        """Day, dusk or night."""
        return str(self.page.evaluate("document.documentElement.dataset.theme"))

    def switches_theme(self) -> None:
        """Press the theme button."""
        self.page.get_by_role("button", name=re.compile("^Theme:")).click()

    def asks_for_help(self) -> None:
        """Open the help sheet."""
        self.page.get_by_role("button", name="Help and keys").click()

    def holds_the_map(self) -> None:
        """Zoom out a step: from then on the map stays where it is."""
        self.presses("-")

    def has_webgl(self) -> bool:
        """Whether this browser can draw with WebGL at all."""
        return bool(self.page.evaluate("document.createElement('canvas').getContext('webgl') !== null"))

    def faults_of_access(self, axe: Path) -> list[str]:
        """What axe finds wrong on the page as it stands: rule and the first element of each."""
        if not self.page.evaluate("'axe' in window"):
            self.page.evaluate(axe.read_text())
        found: list[str] = self.page.evaluate(
            """async () => (await axe.run()).violations.map(({id, help, nodes}) =>
              `${id}: ${help}: ${nodes.map(({target}) => target.join(' ')).join(', ')}`)"""
        )
        return found


def _seconds(words: str) -> float:
    """Seconds of "12 s", "3 min 05 s", "2 h 04 min"."""
    units = {"s": 1, "min": 60, "h": 3600}
    return float(sum(int(count) * units[unit] for count, unit in re.findall(r"(\d+) (s|min|h)\b", words)))
