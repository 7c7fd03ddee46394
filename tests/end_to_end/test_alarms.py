"""An alarm stands before the commander until a person has answered it."""

import re
import time
from pathlib import Path

import msgspec
import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import Reading, alarm, base, heard, responder
from tests.running import Post, Server, eventually, stopped

# A call elsewhere, too, takes the help sheet away.
pytestmark = pytest.mark.usefixtures("nothing_left_open")

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
    eventually(lambda: commander.banners)
    return incident


def test_a_mayday_stands_until_a_person_has_acknowledged_and_cleared_it(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(server, post, commander)
    assert "MAYDAY E7-1" in commander.banners[0]
    eventually(lambda: commander.colour(ALARM_RED).count > 100)
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


def test_a_second_tap_of_a_hand_in_a_glove_clears_no_mayday(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(server, post, commander)
    commander.taps_again_and_again("Acknowledge")
    commander.page.wait_for_timeout(1500)
    assert "acknowledged" in commander.banners[0]
    assert [one["state"] for one in spoken_by_command_post(post, incident)] == ["acknowledged"]


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


def test_a_mayday_of_a_unit_whose_clock_is_an_hour_ahead_is_heard_and_can_be_answered(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident(clock="live")
    now = time.time()
    heard(post, incident, base(now), responder(now, "e7-1", "E7", [3, 3, 0]))
    commander.opens(server.url, incident)
    heard(post, incident, alarm(now + 3600, "e7-1"))
    eventually(lambda: re.search(r"MAYDAY E7-1 .*raised \d+ s ago", " ".join(commander.banners)))
    commander.acknowledges()
    eventually(lambda: "acknowledged" in commander.banners[0])
    commander.clears()
    eventually(lambda: commander.banners == [])


def test_an_answer_that_is_lost_on_its_way_keeps_nobody_from_giving_it_again(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(server, post, commander)
    mends = commander.loses_what_it_sends("/telemetry")
    commander.acknowledges()
    eventually(lambda: "Not sent" in commander.alarm_words)
    mends()
    commander.acknowledges()
    eventually(lambda: "acknowledged" in commander.banners[0])
    assert "Not sent" not in commander.alarm_words
    assert [one["state"] for one in spoken_by_command_post(post, incident)] == ["acknowledged"]


def test_an_answer_that_is_in_the_log_is_not_taken_back_by_pictures_that_do_not_have_it_yet(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(server, post, commander)
    (worker,) = server.worker_pids()
    with stopped(worker, server.data / "firethread.db"):
        commander.acknowledges()
        eventually(lambda: "acknowledged" in commander.banners[0])
        commander.page.wait_for_timeout(2500)
        assert "acknowledged" in commander.banners[0]
        commander.clears()
        eventually(lambda: commander.banners == [])
        commander.page.wait_for_timeout(2500)
        assert commander.banners == []
    heard(post, incident, alarm(time.time(), "e7-1", kind="pass"))
    eventually(lambda: commander.banners)
    assert "PASS E7-1" in commander.banners[0]
    assert "MAYDAY" not in commander.alarm_words


def test_the_board_has_room_for_the_callsign_of_a_responder_in_trouble_and_stale(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [3, 3, 0]), alarm(T0 + 20, "walker"))
    commander.opens(server.url, incident)
    commander.sees("WALKER", "Stale")
    eventually(lambda: commander.banners)
    assert commander.cut_off() == []


def test_who_calls_from_nobody_knows_where_is_said_to_be_nowhere_on_the_map(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    ghost = {"kind": "node", "t": T0, "node": "ghost", "role": "responder", "callsign": "GHOST"}
    heard(post, incident, base(T0), responder(T0, "ff1", "A", [3, 3, 0]), ghost, alarm(T0, "ghost"))
    commander.opens(server.url, incident)
    eventually(lambda: commander.banners)
    assert "MAYDAY GHOST position not known" in commander.banners[0]
    assert "Not on the map, no fix yet: GHOST" in commander.board_words


def test_who_calls_and_whose_unit_is_given_up_stays_on_the_map_and_is_not_said_to_be_out(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    given_up = {"kind": "retire", "t": T0 + 2, "node": "ff1", "reason": "unit lost"}
    heard(post, incident, base(T0), responder(T0, "ff1", "A", [3, 3, 0]), alarm(T0 + 1, "ff1"), given_up)
    commander.opens(server.url, incident)
    eventually(lambda: commander.banners)
    assert commander.board()["FF1"].status == "Not tracked"
    eventually(lambda: commander.colour(ALARM_RED).count > 300)


def test_a_call_tells_the_age_of_the_place_beside_that_of_the_call_where_they_differ(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident(clock="live", settings={"stale_after_s": 60, "lost_after_s": 600})
    now = time.time()
    quiet = responder(now - 90, "quiet", "A", [2, 2, 0])
    heard(post, incident, base(now), quiet, responder(now, "heard", "A", [4, 2, 0]))
    heard(post, incident, alarm(now, "quiet"), alarm(now, "heard", kind="pass"))
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 2)
    mayday, other = commander.banners
    assert re.search(r"MAYDAY QUIET .*STALE .+ raised \d+ s ago", mayday)
    assert re.search(r"PASS HEARD (?!.*STALE).*raised \d+ s ago", other)


def test_a_sound_that_the_system_has_taken_away_is_not_said_to_be_on(
    server: Server, post: Post, commander: Commander
) -> None:
    commander.may_lose_the_sound()
    in_trouble(server, post, commander)
    commander.turns_trails_off()
    eventually(lambda: "Sound is off" in commander.alarm_words)
    commander.selects("e7-1")
    eventually(lambda: "Sound is off" not in commander.alarm_words)
    commander.loses_the_sound()
    eventually(lambda: "Sound is off" in commander.alarm_words)
    commander.selects("e7-1")
    eventually(lambda: "Sound is off" not in commander.alarm_words)


def test_calls_for_which_there_is_no_room_are_named_and_a_press_away(
    server: Server, post: Post, commander: Commander, axe: Path
) -> None:
    incident = post.open_incident()
    names = ("first", "second", "third", "fourth", "fifth")
    crew = [responder(T0, name, "A", [2 * at, 2, 0]) for at, name in enumerate(names)]
    calls = [alarm(T0 + at, name, text="Trapped. " * 80) for at, name in enumerate(names[:4])]
    heard(post, incident, base(T0), *crew, *calls, alarm(T0 + 4, "fifth", kind="pass"))
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    eventually(lambda: commander.calls_not_in_view == "2 not in view: MAYDAY FOURTH, PASS FIFTH")
    assert commander.faults_of_access(axe) == []
    commander.looks_at_calls_not_in_view()
    eventually(lambda: commander.calls_not_in_view == "2 not in view: MAYDAY FIRST, MAYDAY SECOND")
    commander.looks_at_calls_not_in_view()
    eventually(lambda: commander.calls_not_in_view == "2 not in view: MAYDAY FOURTH, PASS FIFTH")


def test_a_call_takes_the_help_sheet_away_which_may_be_opened_again_while_it_stands(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    commander.opens(server.url, incident)
    commander.asks_for_help()
    assert commander.reads_help
    heard(post, incident, alarm(T0 + 1, "walker"))
    eventually(lambda: commander.banners and not commander.reads_help)
    commander.asks_for_help()
    heard(post, incident, {"kind": "status", "t": T0 + 2, "node": "walker", "battery": 0.5})
    eventually(lambda: commander.clock and commander.reads_help)
