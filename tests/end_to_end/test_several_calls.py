"""Several call for help at once, or one in several ways: each person is seen, with the button to answer."""

import re

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import Reading, alarm, base, heard, recorded, responder, step
from tests.end_to_end.test_alarms import spoken_by_command_post
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")

T0 = 1_763_712_345.0
LUNAR = (
    "Location: second floor, corridor side of room S4, low wall collapsed. Unit: Ladder 3, L3-2. "
    "Name: Novak. Assignment: primary search. Resources: two rescuers and a cutter, air below 150 bar."
)
LOW_AIR: Reading = {"kind": "status", "t": T0, "node": "ff0", "air_bar": 40}


def in_trouble(post: Post, *calls: Reading) -> str:
    """An incident of a crew of four in which somebody calls; its identifier."""
    incident = post.open_incident()
    crew = [responder(T0, f"ff{at}", "A", [4 * at, 3, 0]) for at in range(4)]
    heard(post, incident, base(T0), *crew, *calls)
    return incident


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1366, 768), (1024, 768), (768, 1024)])
@pytest.mark.parametrize("warned", [False, True], ids=["calm", "low-air"])
def test_two_who_call_are_both_seen_with_what_they_say_and_can_be_answered(
    server: Server, post: Post, commander: Commander, width: int, height: int, warned: bool
) -> None:
    still = alarm(T0, "ff1", kind="pass", text="no movement for 30 s")
    calls = [still, alarm(T0 + 30, "ff1", text=LUNAR), alarm(T0 + 33, "ff2", text=LUNAR)]
    incident = in_trouble(post, *calls, *([LOW_AIR] if warned else []))
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 2 and bool(commander.low_on_air) == warned)
    assert (commander.calls_half_seen, commander.calls_not_in_view) == ([], "")
    commander.acknowledges()
    eventually(lambda: "acknowledged" in commander.banners[1])
    assert (commander.calls_half_seen, commander.calls_not_in_view) == ([], "")
    assert commander.map_height >= 0.28 * height


def test_however_much_the_first_says_two_others_are_seen(
    server: Server, post: Post, commander: Commander
) -> None:
    wordy = alarm(T0, "ff1", text="Trapped under a shelf, partner unconscious, second exit blocked. " * 12)
    incident = in_trouble(post, wordy, alarm(T0 + 1, "ff2"), alarm(T0 + 2, "ff3", kind="pass"))
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 3)
    assert (commander.calls_half_seen, commander.calls_not_in_view) == ([], "")


def test_what_the_alarm_has_no_room_for_is_read_whole_on_the_callers_card(
    server: Server, post: Post, commander: Commander
) -> None:
    words = "Trapped under a shelf, partner unconscious, second exit blocked. " * 12
    incident = in_trouble(post, alarm(T0, "ff1", text=words), alarm(T0 + 1, "ff2", text="Lost."))
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 2)
    assert not commander.words_said_whole(0)
    assert commander.words_said_whole(1)
    commander.goes_to_the_alarm()
    eventually(lambda: f"MAYDAY {words.strip()}" in " ".join(commander.card.split()))
    assert (commander.calls_half_seen, commander.calls_not_in_view) == ([], "")


def test_who_calls_alone_says_all_of_it_in_the_alarm_and_not_twice(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(
        post, alarm(T0, "ff1", text=LUNAR), alarm(T0 + 1, "ff1", kind="pass", text="Still.")
    )
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 1)
    assert f"{LUNAR} · PASS: Still." in commander.banners[0]
    assert commander.words_said_whole(0)
    commander.goes_to_the_alarm()
    eventually(lambda: commander.card)
    assert "MAYDAY" not in commander.card


def test_one_press_answers_all_that_one_person_calls_by_and_each_call_in_the_log(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(post, alarm(T0, "ff1", kind="pass"), alarm(T0 + 30, "ff1"))
    commander.opens(server.url, incident)
    eventually(lambda: commander.banners)
    assert len(commander.banners) == 1
    assert re.search(r"MAYDAY FF1 .*raised 0 s ago PASS raised 30 s ago", commander.banners[0])
    commander.acknowledges()
    eventually(lambda: "acknowledged" in commander.banners[0])
    commander.clears()
    eventually(lambda: commander.banners == [])
    spoken = [(one["alarm"], one["state"]) for one in spoken_by_command_post(post, incident)]
    assert spoken == [
        ("mayday", "acknowledged"),
        ("pass", "acknowledged"),
        ("mayday", "cleared"),
        ("pass", "cleared"),
    ]


def test_who_lies_still_after_his_mayday_was_answered_calls_again(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = in_trouble(post, alarm(T0, "ff1"), alarm(T0 + 1, "ff2"))
    commander.opens(server.url, incident)
    for _ in range(2):
        eventually(lambda: commander.alarm_answers == "Acknowledge")
        commander.acknowledges()
    eventually(lambda: commander.alarm_answers == "Clear")
    heard(post, incident, alarm(T0 + 60, "ff2", kind="pass"))
    eventually(lambda: commander.alarm_answers == "Acknowledge")
    assert "MAYDAY FF2" in commander.banners[0]
    commander.acknowledges()
    eventually(lambda: commander.alarm_answers == "Clear")
    assert [one["alarm"] for one in spoken_by_command_post(post, incident)] == ["mayday", "mayday", "pass"]


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (768, 1024), (390, 844)])
@pytest.mark.parametrize("called", [False, True], ids=["calm", "calls"])
def test_words_of_the_past_hide_no_button_of_the_map_and_nobody_on_the_board(
    server: Server, post: Post, commander: Commander, width: int, height: int, called: bool
) -> None:
    calls = [alarm(T0 + 4, "ff1", text=LUNAR), alarm(T0 + 5, "ff2", text=LUNAR)] if called else []
    incident = in_trouble(post, {"kind": "drop", "t": T0 + 3, "node": "crumb", "by": "ff3"}, *calls)
    heard(post, incident, *(step(T0 + 8, f"ff{at}", [1, 0, 0]) for at in range(4)))
    recorded(post, incident, T0 + 8)
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    commander.scrubs_to(T0 + 3)
    eventually(lambda: "crumb dropped" in commander.event)
    commander.compares()
    eventually(lambda: commander.words_of_the_comparison.startswith("Crosses"))
    assert commander.under_words_of_the_past == []
