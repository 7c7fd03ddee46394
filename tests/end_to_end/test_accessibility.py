"""axe finds nothing wrong, whatever lies open."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, base, heard, responder, two_on_two_storeys
from tests.running import Post, Server, eventually, running

THEMES = ["day", "dusk", "night"]


@pytest.fixture
def own_server(tmp_path: Path) -> Iterator[Server]:
    """A server that this test may kill."""
    with running(tmp_path / "data") as server:
        yield server.until_it_computes()


def test_axe_finds_no_fault_by_day_dusk_and_night(
    own_server: Server, commander: Commander, axe: Path
) -> None:
    post = Post(own_server.url)
    incident = post.open_incident(clock="live", settings={"stale_after_s": 1, "lost_after_s": 60})
    now = time.time()
    heard(
        post,
        incident,
        base(now),
        responder(now, "ff1", "A", [2, 2, 0]),
        responder(now, "ff2", "B", [4, 2, 0]),
    )
    commander.opens(own_server.url, incident)
    found: dict[str, list[str]] = {}

    def look(what: str) -> None:
        for theme in THEMES:
            assert commander.theme == theme
            found[f"{what} by {theme}"] = commander.faults_of_access(axe)
            commander.switches_theme()

    look("calm")
    heard(post, incident, alarm(time.time(), "ff1"), alarm(time.time(), "ff2", kind="pass"))
    eventually(lambda: len(commander.banners) == 2)
    commander.selects("ff2")
    look("two alarms and a card")
    commander.acknowledges()
    eventually(lambda: any("acknowledged" in text for text in commander.banners))
    look("an acknowledged alarm")
    for theme in THEMES:
        commander.asks_for_help()
        found[f"help by {theme}"] = commander.faults_of_access(axe)
        commander.presses("Escape")
        commander.switches_theme()
    commander.plays()
    eventually(lambda: commander.mode == "REPLAY")
    look("replay")
    commander.goes_back_to_live()
    eventually(lambda: commander.mode == "LIVE")
    own_server.kill_web()
    eventually(lambda: commander.connection_lost, within_s=6)
    look("the connection lost")

    post.http.close()
    assert {what: faults for what, faults in found.items() if faults} == {}


def test_in_the_systems_own_colours_the_chosen_storey_and_an_alarm_are_still_told(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = two_on_two_storeys(post, 1_763_712_345.0)
    heard(post, incident, alarm(1_763_712_354.0, "ff1"))
    commander.sees_the_systems_colours()
    commander.opens(server.url, incident)
    eventually(lambda: commander.banners)
    before = commander.storey_colours()
    assert len(set(before.values())) == 2
    commander.chooses_storey("First")
    eventually(lambda: (now := commander.storey_colours())["First"] == before["All"] != now["All"])
    assert commander.alarm_colour not in before.values()
