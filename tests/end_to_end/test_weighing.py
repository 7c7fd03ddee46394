"""To weigh what holds a fix may take minutes: who asks hears for how long, and is told in the end."""

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import base, heard, recorded, responder, step
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")

T0 = 1_763_712_345.0


def walked(post: Post) -> str:
    """A recorded incident with one responder inside; its identifier."""
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    for second in range(1, 60):
        heard(post, incident, step(T0 + second, "walker", [0.5, 0, 0]))
    recorded(post, incident, T0 + 58)
    return incident


def test_an_answer_that_takes_minutes_comes_by_itself_and_until_then_it_is_said_how_long_it_has_taken(
    server: Server, post: Post, commander: Commander
) -> None:
    commander.opens(server.url, walked(post))
    commander.selects("walker")
    commander.hears_that_it_takes_long(times=2)
    commander.begins_to_ask_why_here()
    eventually(lambda: commander.weighed_so_far.endswith("s so far"))
    assert "Not known" not in commander.card
    eventually(commander.is_told_what_holds, within_s=60)
    assert len(commander.asked_about) == 3
    eventually(lambda: commander.weighed_so_far == "", within_s=60)


def test_while_a_replay_plays_on_it_stays_one_question_about_one_moment(
    server: Server, post: Post, commander: Commander
) -> None:
    commander.opens(server.url, walked(post))
    commander.scrubs_to(T0 + 20)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    commander.selects("walker")
    commander.hears_that_it_takes_long(times=2)
    commander.plays()
    commander.begins_to_ask_why_here()
    eventually(commander.is_told_what_holds, within_s=60)
    assert len(commander.asked_about) == 3
    assert len(set(commander.asked_about)) == 1
    assert commander.asked_about[0] is not None


def test_who_asks_at_the_foot_of_the_board_sees_that_it_is_weighed(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    crew = [responder(T0, f"ff{at:02}", "A", [2 * at, 2, 0]) for at in range(12)]
    heard(post, incident, base(T0), *crew)
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    commander.selects("ff11")
    commander.hears_that_it_takes_long(times=2)
    commander.begins_to_ask_why_here()
    eventually(lambda: commander.weighed_so_far)
    assert commander.sees_that_it_is_weighed
