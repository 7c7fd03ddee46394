"""A fix that ages says so, by word, age and shape."""

import time

from tests.end_to_end.canvas import FIRST_CREW
from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import base, heard, responder, step
from tests.running import Post, Server, eventually


def test_a_responder_who_falls_silent_turns_stale_then_lost_in_word_and_shape(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident(clock="live", settings={"stale_after_s": 2, "lost_after_s": 4})
    commander.page.goto(f"{server.url}/#incident={incident}")
    now = time.time()
    heard(post, incident, base(now), responder(now, "quiet", "A", [3, 3, 0]))

    commander.sees("QUIET", "Live")
    commander.turns_trails_off()
    assert commander.counts == "1 responder 1 live 0 stale 0 lost"
    eventually(lambda: commander.shape(FIRST_CREW) == "round", within_s=2)

    commander.sees("QUIET", "Stale")
    assert 2 <= commander.board()["QUIET"].age_s <= 3
    eventually(lambda: commander.shape(FIRST_CREW) == "diamond", within_s=2)

    commander.sees("QUIET", "Lost")
    assert 4 <= commander.board()["QUIET"].age_s <= 5
    eventually(lambda: commander.shape(FIRST_CREW) == "square", within_s=2)
    assert commander.counts == "1 responder 0 live 0 stale 1 lost"

    heard(post, incident, step(time.time(), "quiet", [0, 0, 0]))
    commander.sees("QUIET", "Live", within_s=2)
