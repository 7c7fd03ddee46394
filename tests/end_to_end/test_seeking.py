"""However a moment of the past is sought, what is shown and the time that is said belong together."""

import time
from datetime import datetime

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import LEVELS, base, heard, one_inside, recorded, responder, step
from tests.running import Post, Server, eventually

T0 = 1_763_712_345.0
LONG_S = 59


@pytest.fixture
def walked(server: Server, post: Post, commander: Commander) -> str:
    """An incident on the screen in which one walks for a minute, while nothing more is heard of the other."""
    incident = post.open_incident()
    heard(
        post,
        incident,
        base(T0),
        responder(T0, "walker", "A", [2, 2, 0]),
        responder(T0, "quiet", "B", [4, 3, 0]),
    )
    heard(post, incident, *(step(T0 + second, "walker", [0.5, 0.2, 0]) for second in range(1, LONG_S + 1)))
    recorded(post, incident, T0 + LONG_S)
    commander.opens(server.url, incident)
    return incident


def test_until_the_past_has_come_the_present_stays_and_says_that_it_is(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    comes = commander.waits_for_pictures("/replay")
    commander.opens(server.url, incident)
    began = time.time()
    eventually(lambda: time.time() > began + 3)
    heard(post, incident, step(time.time(), "walker", [1, 0, 0]))
    commander.scrubs_to(began)
    eventually(lambda: commander.asked.startswith("→"))
    for _ in range(20):
        assert (commander.mode, set(commander.board())) == ("LIVE", {"WALKER"})
        assert commander.clock > commander.asked.strip("→\u00a0")
        time.sleep(0.05)

    comes()
    eventually(lambda: commander.mode == "REPLAY" and not commander.asked.startswith("→"))
    assert commander.clock == commander.asked
    commander.goes_back_to_live()
    eventually(lambda: commander.mode == "LIVE")


def test_of_an_incident_that_goes_on_over_midnight_every_time_is_told_with_its_day(
    server: Server, post: Post, commander: Commander
) -> None:
    midnight = datetime(2025, 11, 22).timestamp()  # noqa: DTZ001 - the commander's own
    incident = post.open_incident()
    heard(post, incident, base(midnight - 600), responder(midnight - 600, "walker", "A", [2, 2, 0]))
    heard(post, incident, *(step(midnight + 100 * at, "walker", [1, 0, 0]) for at in range(-5, 7)))
    recorded(post, incident, midnight + 600)
    commander.opens(server.url, incident)
    assert commander.days_end_at == ["Nov 22, 2025"]
    for t, day, clock in (
        (midnight - 90, "Nov 21, 2025", "23:58:30"),
        (midnight, "Nov 22, 2025", "00:00:00"),
    ):
        commander.scrubs_to(t)
        eventually(lambda clock=clock: commander.mode == "REPLAY" and commander.clock == clock)
        assert commander.other_day == day
        assert commander.asked_aloud == f"{day}, {clock}"
    commander.scrubs_to(midnight - 2)
    commander.plays()
    eventually(lambda: (commander.other_day, commander.clock[:5]) == ("Nov 22, 2025", "00:00"))


def test_storeys_that_are_named_under_way_are_marked_and_the_past_keeps_its_own(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    began = time.time()
    recorded(post, incident, began - 1)
    eventually(lambda: time.time() > began + 3)
    assert post.http.patch(f"/incidents/{incident}", json={"levels": LEVELS}).status_code == 200
    heard(post, incident, step(time.time(), "walker", [1, 0, 0]))
    commander.opens(server.url, incident)
    eventually(lambda: commander.was_set == ["Set: storeys"])
    assert {"Ground", "First"} <= set(commander.storeys)

    commander.scrubs_to(began)
    eventually(lambda: commander.mode == "REPLAY" and not {"Ground", "First"} & set(commander.storeys))
    commander.goes_back_to_live()
    eventually(lambda: commander.mode == "LIVE" and {"Ground", "First"} <= set(commander.storeys))


def test_the_handle_of_what_is_live_stands_at_the_end_from_the_first_second_on(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    commander.opens(server.url, incident)
    for _ in range(10):
        assert commander.handle_short_of_end_s < 0.01
        time.sleep(0.2)


@pytest.mark.usefixtures("walked")
def test_under_a_storm_of_seeks_no_picture_stands_under_another_moment(commander: Commander) -> None:
    commander.notes_the_board()
    sought = [T0 + 1 + (17 * number) % 57 for number in range(30)]
    for t in sought:
        commander.scrubs_to(t)
    eventually(lambda: commander.board() and commander.board()["QUIET"].age_s == sought[-1] - T0)
    # He reports each second: whenever he is shown, it is as he was just then.
    assert {age for name, _, age in commander.notes if name == "WALKER"} == {"0 s"}


@pytest.mark.usefixtures("walked")
def test_the_handle_stays_under_the_finger_that_leads_it_from_now_into_the_past(commander: Commander) -> None:
    commander.drags_the_handle(to=0.3)
    # On the way there it was shown what lies between.
    eventually(lambda: commander.mode == "REPLAY" and not commander.asked.startswith("→"))
    assert commander.board()["QUIET"].age_s == pytest.approx(0.3 * LONG_S, abs=3)


@pytest.mark.usefixtures("walked")
def test_who_steps_back_from_the_end_of_a_replay_sees_it_stand_as_its_button_says(
    commander: Commander,
) -> None:
    newest = commander.clock
    commander.scrubs_to(T0 + LONG_S - 2)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    commander.plays()
    eventually(lambda: commander.play_button == "Play" and commander.clock == newest)
    for _ in range(5):
        commander.presses("ArrowLeft")
    eventually(lambda: commander.board()["QUIET"].age_s == LONG_S - 5)
    stands = commander.clock
    time.sleep(2.5)  # in which a replay that goes on would be seen to
    assert (commander.clock, commander.play_button) == (stands, "Play")


def test_in_a_recorded_incident_what_was_named_under_way_is_marked_where_it_stood_then(
    server: Server, post: Post, commander: Commander
) -> None:
    t = 1_763_712_345.0
    incident = post.open_incident()
    heard(post, incident, base(t), responder(t, "walker", "A", [2, 2, 0]))
    heard(post, incident, step(t + 4, "walker", [1, 0, 0]))
    assert post.http.patch(f"/incidents/{incident}", json={"levels": LEVELS}).status_code == 200
    heard(post, incident, step(t + 8, "walker", [1, 0, 0]))
    commander.opens(server.url, incident)
    eventually(lambda: commander.was_set == ["Set: storeys"])
    commander.scrubs_to(t + 4)
    eventually(lambda: commander.event == "Set: storeys")


def test_what_is_named_while_a_recorded_incident_is_looked_at_is_marked_without_opening_it_again(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    heard(post, incident, step(T0 + 4, "walker", [1, 0, 0]))
    recorded(post, incident, T0 + 3)
    commander.opens(server.url, incident)
    assert post.http.patch(f"/incidents/{incident}", json={"levels": LEVELS}).status_code == 200
    heard(post, incident, step(T0 + 8, "walker", [1, 0, 0]))
    eventually(lambda: commander.was_set == ["Set: storeys"], within_s=30)
    commander.scrubs_to(T0 + 4)
    eventually(lambda: commander.event == "Set: storeys")
