"""The device that the commander holds: it sleeps, gives everything its own colours, has a slow link."""

import re
from collections.abc import Callable

from playwright.sync_api import Route, WebSocketRoute

from tests.end_to_end.fingers import FingersUsed


class DeviceUsed(FingersUsed):
    """What becomes of it.

    Args:
        page: a page of the browser.
    """

    def sleeps(self, seconds: float) -> Callable[[], None]:
        """Wake up after that: only the wall clock has gone on; what lets the server answer."""
        self.page.evaluate(
            """(slept) => {
              const [now, Socket] = [Date.now, window.WebSocket];
              Date.now = () => now() + 1000 * slept;
              const answered = new Promise((answer) => { window.theServerAnswers = answer; });
              window.WebSocket = class {
                constructor(address) {
                  answered.then(() => this.closed || Object.assign(new Socket(address), this));
                }
                close() { this.closed = true; }
              };
            }""",
            seconds,
        )
        return lambda: self.page.evaluate("window.theServerAnswers()")

    def waits_for_pictures(self, of: str = "/live") -> Callable[[], None]:
        """From the next page on no live (or `/replay`) picture comes through; what lets them through."""
        held: list[Callable[[], None]] = []
        free = False

        def told(here: WebSocketRoute) -> None:
            server = here.connect_to_server()

            def hand_on(message: str | bytes) -> None:
                if free:
                    here.send(message)
                else:
                    held.append(lambda: here.send(message))

            server.on_message(hand_on)

        def let_through() -> None:
            nonlocal free
            free = True
            for send in held:
                send()

        self.page.route_web_socket(re.compile(of), told)
        return let_through

    def loses_what_it_sends(self, to: str) -> Callable[[], None]:
        """No answer comes to what is sent to a path, nor word that none will come; what mends that."""
        address = re.compile(to)
        self.page.route(address, lambda _: None)
        return lambda: self.page.unroute(address)

    def holds_what_it_sends(self, to: str) -> Callable[[], None]:
        """What is sent to a path waits; what lets it through, and all that follows."""
        address, held = re.compile(to), list[Route]()
        free = False

        def hold(route: Route) -> None:
            if free:
                route.continue_()
            else:
                held.append(route)

        def let_through() -> None:
            nonlocal free
            free = True
            for route in held:
                route.continue_()
            self.page.unroute(address, hold)

        self.page.route(address, hold)
        return let_through

    def may_lose_the_sound(self) -> None:
        """From the next page on the system can take the sound away, as a call or a lock screen does."""
        self.page.add_init_script(
            """window.AudioContext = class extends AudioContext {
              constructor() { super(); window.theSound = this; }
            };"""
        )

    def loses_the_sound(self) -> None:
        """Have the system take it away."""
        self.page.evaluate("window.theSound.suspend()")

    def may_go_dark(self) -> None:
        """From the next page on it is seen whether the screen is kept lit, and the system can darken it."""
        self.page.add_init_script(
            """Object.defineProperty(navigator, 'wakeLock', {value: {request: async () => {
              const light = {released: false, release: async () => { light.released = true; }};
              window.theLight = light;
              return light;
            }}});"""
        )

    def goes_dark(self) -> None:
        """Have the system let the screen go dark, and the commander wake it by a touch on the clock."""
        self.page.evaluate("window.theLight.release()")
        self.page.get_by_test_id("clock").click()

    @property
    def is_kept_lit(self) -> bool:
        """Whether the screen is kept lit."""
        return bool(self.page.evaluate("window.theLight !== undefined && !window.theLight.released"))

    def reads_with_larger_text(self, times: float) -> None:
        """Have the browser's own size of text set to so many times the usual one, as who sees badly does."""
        devtools = self.page.context.new_cdp_session(self.page)
        devtools.send("Page.enable")
        sizes = {"standard": round(16 * times), "fixed": round(13 * times)}
        devtools.send("Page.setFontSizes", {"fontSizes": sizes})

    def swipes_back(self) -> None:
        """Swipe in from the edge as who wears gloves does unawares: the browser goes back."""
        self.page.evaluate("history.back()")

    def has_asked_for(self, path: str) -> bool:
        """Whether the page has asked the server for what lies under a path by now."""
        asked: list[str] = self.page.evaluate(
            "performance.getEntriesByType('resource').map(({name}) => name)"
        )
        return any(path in url for url in asked)

    def sees_the_systems_colours(self) -> None:
        """Have the system choose all colours (forced colours, high contrast)."""
        self.page.emulate_media(forced_colors="active")

    def storey_colours(self) -> dict[str, str]:
        """The ground of each storey button, by its name."""
        colours: dict[str, str] = self.page.get_by_test_id("storeys").evaluate(
            """(bar) => Object.fromEntries([...bar.querySelectorAll('button')].map((button) =>
              [button.querySelector('.name').textContent, getComputedStyle(button).backgroundColor]))"""
        )
        return colours

    @property
    def alarm_colour(self) -> str:
        """The ground of the first alarm."""
        banner = self.page.get_by_test_id("alarm").first
        return str(banner.evaluate("(banner) => getComputedStyle(banner).backgroundColor"))

    @property
    def words_of_the_loss(self) -> str:
        """What is said of a lost connection; nothing without one."""
        sign = self.page.get_by_test_id("connection-lost")
        return " ".join(sign.inner_text().split()) if sign.count() else ""
