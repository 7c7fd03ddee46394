"""A server, a browser and a commander before it."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, sync_playwright

from tests.end_to_end.commander import Commander
from tests.needs import missing
from tests.running import Server, close_all

ROOT = Path(__file__).resolve().parents[2]
SCREEN = ROOT / "backend" / "screen" / "index.html"
AXE = ROOT / "frontend" / "node_modules" / "axe-core" / "axe.min.js"
# No graphics processor and no WebGL, as on a borrowed tablet; and nothing that calls home.
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-software-rasterizer",
    "--disable-3d-apis",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


# One for this package, not one a session: while it runs, no other test could run an event loop of its own.
@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Chromium without a window."""
    if not SCREEN.is_file():
        missing(f"the built screen {SCREEN}", "run `make setup`, which builds it from frontend/")
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None:
        missing("Chromium", "install it so that `chromium` is on the path")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def nothing_left_open(server: Server) -> None:
    """Close what was opened before: calls for help in it would be told on every screen."""
    close_all(server)


@pytest.fixture
def commander(browser: Browser) -> Iterator[Commander]:
    """A commander with a fresh page; at the end no error may have gone unhandled on it."""
    context = browser.new_context(viewport={"width": 1280, "height": 800}, color_scheme="light")
    context.set_default_timeout(15_000)
    commander = Commander(context.new_page())
    yield commander
    context.close()
    assert commander.faults == []


@pytest.fixture(scope="session")
def axe() -> Path:
    """The script that looks for faults of accessibility."""
    if not AXE.is_file():
        missing(f"axe ({AXE})", "run `make setup`, which installs it")
    return AXE
