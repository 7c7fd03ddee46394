"""An alarm stands before the commander until a person has answered it."""

import time

import msgspec

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import Reading, alarm, base, heard, responder
from tests.running import Post, Server, eventually

T0 = 1_763_712_345.0
ALARM_RED = "#b80f26"


def spoken_by_command_post(post: Post, incident: str) -> list[Reading]:
    """The readings in the log that came from the screen of the command post."""
    batches = [msgspec.json.decode(line) for line in post.log(incident)]
    return [
        reading for batch in batches if batch["gateway"] == "command-post" for reading in batch["readings"]
    ]


def in_trouble(server: Server, post: Post, commander: Commander) -> str:
    """An incident in which E7-1 has called mayday, on the commander's screen."""
    incident = post.open_incident(clock="live")
    now = time.time()
    heard(post, incident, base(now), responder(now, "e7-1", "E7", [3, 3, 0]))
    commander.opens(server.url, incident)
    assert commander.banners == []
    assert commander.colour(ALARM_RED).count == 0
    heard(post, incident, alarm(time.time(), "e7-1"))
    eventually(lambda: commander.banners, within_s=2)
    return incident


def test_a_mayday_stands_until_a_person_has_acknowledged_and_cleared_it(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(server, post, commander)
    assert "MAYDAY E7-1" in commander.banners[0]
    eventually(lambda: commander.colour(ALARM_RED).count > 100, within_s=2)
    assert spoken_by_command_post(post, incident) == []

    commander.acknowledges()
    eventually(lambda: "acknowledged" in commander.banners[0])
    commander.clears()
    eventually(lambda: commander.banners == [])
    eventually(lambda: commander.colour(ALARM_RED).count == 0)

    spoken = spoken_by_command_post(post, incident)
    assert [(one["kind"], one["node"], one["alarm"], one["state"]) for one in spoken] == [
        ("alarm", "e7-1", "mayday", "acknowledged"),
        ("alarm", "e7-1", "mayday", "cleared"),
    ]
    eventually(lambda: post.frame(incident)["alarms"] == [])


def test_a_mayday_that_the_unit_clears_by_itself_stands_until_a_person_has_seen_it(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(server, post, commander)
    heard(post, incident, alarm(time.time(), "e7-1", state="cleared"))
    eventually(lambda: "cleared by the unit" in commander.banners[0])
    assert "MAYDAY E7-1" in commander.banners[0]

    commander.acknowledges()
    eventually(lambda: commander.banners == [])
    states = [one["state"] for one in spoken_by_command_post(post, incident)]
    assert states == ["acknowledged"]
    eventually(lambda: post.frame(incident)["alarms"] == [])


def test_the_board_has_room_for_the_callsign_of_a_responder_in_trouble_and_stale(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [3, 3, 0]), alarm(T0 + 20, "walker"))
    commander.opens(server.url, incident)
    commander.sees("WALKER", "Stale")
    eventually(lambda: commander.banners)
    assert commander.cut_off() == []
