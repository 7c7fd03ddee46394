"""A call for help in an incident that is not on the screen reaches its commander all the same."""

import time
from pathlib import Path

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, base, heard, responder, two_on_two_storeys
from tests.end_to_end.test_alarms import spoken_by_command_post
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")

T0 = 1_763_712_345.0


def mill(post: Post, name: str = "Mill") -> str:
    """Another incident, of now, with one responder."""
    incident = post.open_incident(name, clock="live")
    now = time.time()
    heard(post, incident, base(now), responder(now, "w1", "W", [3, 3, 0]))
    return incident


def test_a_mayday_in_another_incident_is_seen_and_one_tap_leads_there_and_back(
    server: Server, post: Post, commander: Commander
) -> None:
    here, there = two_on_two_storeys(post, T0), mill(post)
    commander.follows_link(server.url, here, node="ff2", level=1)
    eventually(lambda: "FF2" in commander.card)
    assert commander.calls_elsewhere == []

    heard(post, there, alarm(time.time(), "w1"))
    eventually(lambda: commander.calls_elsewhere)
    assert "MAYDAY W1 in Mill" in commander.calls_elsewhere[0]
    assert commander.spoken_of_elsewhere == "MAYDAY W1 in Mill."
    # What was shown stands as it did: it is no alarm of this incident.
    assert (commander.incident, commander.selected, commander.storey) == ("Office", "ff2", "First")
    assert commander.banners == []

    commander.goes_to_the_call_elsewhere()
    eventually(lambda: commander.incident == "Mill" and commander.banners)
    assert "MAYDAY W1" in commander.banners[0]
    eventually(lambda: "W1" in commander.card)
    assert commander.calls_elsewhere == []
    commander.acknowledges()
    eventually(lambda: "acknowledged" in commander.banners[0])

    assert commander.way_back == "‹ Back to Office"
    commander.takes_the_way_back()
    eventually(lambda: commander.incident == "Office" and "FF2" in commander.card)
    assert (commander.selected, commander.storey, commander.way_back) == ("ff2", "First", "")
    # Somebody is still in trouble there, and somebody knows: it stands, and is not said again.
    eventually(lambda: commander.calls_elsewhere)
    assert "acknowledged" in commander.calls_elsewhere[0]
    assert commander.spoken_of_elsewhere == ""
    heard(post, there, alarm(time.time(), "w1", state="cleared"))
    eventually(lambda: commander.calls_elsewhere == [])


def test_who_is_called_away_from_the_past_comes_back_to_the_same_moment_and_place(
    server: Server, post: Post, commander: Commander
) -> None:
    here, there = two_on_two_storeys(post, T0), mill(post)
    commander.opens(server.url, here)
    commander.turns_trails_off()
    commander.holds_the_map()
    commander.scrubs_to(T0 + 4)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    moment = commander.clock
    place = commander.settled_mark("#56b4e9")

    heard(post, there, alarm(time.time(), "w1", kind="pass"))
    eventually(lambda: commander.calls_elsewhere)
    assert "PASS W1 in Mill" in commander.calls_elsewhere[0]
    assert (commander.mode, commander.clock) == ("REPLAY", moment)

    commander.goes_to_the_call_elsewhere()
    eventually(lambda: commander.incident == "Mill" and commander.mode == "LIVE")
    commander.takes_the_way_back()
    eventually(lambda: commander.incident == "Office" and commander.mode == "REPLAY")
    eventually(lambda: commander.clock == moment)
    eventually(lambda: commander.colour("#56b4e9").count > 100)
    again = commander.settled_mark("#56b4e9")
    assert again.from_middle == pytest.approx(place.from_middle, abs=2)


def test_who_goes_elsewhere_before_both_calls_of_somebody_are_answered_answers_both_where_they_are(
    server: Server, post: Post, commander: Commander
) -> None:
    here, there = mill(post), mill(post, "Dock")
    heard(post, here, alarm(time.time(), "w1"), alarm(time.time(), "w1", kind="pass"))
    commander.opens(server.url, here)
    let_through = commander.holds_what_it_sends("/telemetry")
    commander.acknowledges()
    commander.chooses_incident("Dock")
    eventually(lambda: commander.incident == "Dock" and commander.banners == [])
    let_through()
    eventually(lambda: [one["state"] for one in spoken_by_command_post(post, here)] == 2 * ["acknowledged"])
    assert spoken_by_command_post(post, there) == []


def test_a_call_is_seen_in_an_incident_that_began_after_the_screen_was_opened(
    server: Server, post: Post, commander: Commander
) -> None:
    commander.opens(server.url, two_on_two_storeys(post, T0))
    there = post.open_incident("Barn", clock="live")
    heard(post, there, alarm(time.time(), "unit-7", kind="help"))
    eventually(lambda: commander.calls_elsewhere)
    assert "HELP unit-7 in Barn" in commander.calls_elsewhere[0]

    # Whoever chooses for himself needs no way back.
    commander.chooses_incident("Office")
    assert commander.way_back == ""


def test_the_mayday_of_a_long_named_incident_has_room_on_every_tablet_and_for_gloves(
    server: Server, post: Post, commander: Commander, axe: Path
) -> None:
    here = two_on_two_storeys(post, T0)
    for number in range(5):
        there = mill(post, f"Warehouse {number} of a very long name " * 4)
        heard(post, there, alarm(time.time(), "w1", text="Location: rack 4"))
    commander.opens(server.url, here)
    eventually(lambda: len(commander.calls_elsewhere) == 3)
    eventually(lambda: len(commander.marked_in_the_list) == 5)
    found: dict[str, list[str]] = {}
    for width, height in [(1024, 768), (1280, 800), (768, 1024)]:
        commander.sits_at(width, height)
        assert commander.off_the_screen == []
        assert commander.too_small_for_gloves(48) == []
    for _ in range(3):
        found[f"calls by {commander.theme}"] = commander.faults_of_access(axe)
        commander.switches_theme()
    commander.goes_to_the_call_elsewhere()
    eventually(lambda: commander.way_back)
    assert commander.too_small_for_gloves(48) == []
    for _ in range(3):
        found[f"the way back by {commander.theme}"] = commander.faults_of_access(axe)
        commander.switches_theme()
    assert {what: faults for what, faults in found.items() if faults} == {}


def test_it_is_said_when_the_other_incidents_cannot_be_seen(
    server: Server, post: Post, commander: Commander
) -> None:
    here, there = two_on_two_storeys(post, T0), mill(post)
    commander.opens(server.url, here)
    time.sleep(2)  # a look or two
    assert commander.silence_elsewhere == ""
    commander.cannot_see_other_incidents(cut_off=True)
    eventually(lambda: "Other incidents not heard for" in commander.silence_elsewhere)
    assert not commander.connection_lost
    assert commander.mode == "RECORDED"

    heard(post, there, alarm(time.time(), "w1"))
    commander.cannot_see_other_incidents(cut_off=False)
    eventually(lambda: commander.calls_elsewhere)
    assert commander.silence_elsewhere == ""
