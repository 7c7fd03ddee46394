"""A fix that ages says so, by word, age and shape."""

import time

from tests.end_to_end.canvas import FIRST_CREW
from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import base, heard, responder, step
from tests.running import Post, Server, eventually

T0 = 1_763_712_345.0


def test_a_responder_who_falls_silent_turns_stale_then_lost_in_word_and_shape(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident(clock="live", settings={"stale_after_s": 6, "lost_after_s": 12})
    commander.page.goto(f"{server.url}/#incident={incident}")
    commander.notes_the_board()
    now = time.time()
    heard(post, incident, base(now), responder(now, "quiet", "A", [3, 3, 0]))

    commander.sees("QUIET", "Live")
    commander.turns_trails_off()
    assert commander.counts == "1 responder 1 live 0 stale 0 lost"
    eventually(lambda: commander.shape(FIRST_CREW) == "round")

    commander.sees("QUIET", "Stale")
    eventually(lambda: commander.shape(FIRST_CREW) == "diamond")

    commander.sees("QUIET", "Lost")
    eventually(lambda: commander.shape(FIRST_CREW) == "square")
    noted = commander.noted("QUIET")
    assert list(noted) == ["Live", "Stale", "Lost"]
    assert noted["Stale"] in {"6 s", "7 s"}
    assert noted["Lost"] in {"12 s", "13 s"}
    assert commander.counts == "1 responder 0 live 0 stale 1 lost"
    commander.shows_the_next("lost")
    eventually(lambda: commander.selected == "quiet")

    heard(post, incident, step(time.time(), "quiet", [0, 0, 0]))
    commander.sees("QUIET", "Live")


def test_who_is_not_tracked_any_more_is_told_with_the_reason_and_is_no_responder_inside(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(
        post, incident, base(T0), responder(T0, "ff1", "A", [2, 2, 0]), responder(T0, "ff2", "A", [4, 2, 0])
    )
    heard(post, incident, {"kind": "retire", "t": T0 + 5, "node": "ff2", "reason": "unit burned, man is out"})
    commander.opens(server.url, incident)
    commander.sees("FF2", "Not tracked")
    assert "unit burned, man is out" in commander.board_words
    assert commander.counts == "1 responder 1 live 0 stale 0 lost"
