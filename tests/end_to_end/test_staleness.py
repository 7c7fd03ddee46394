"""A fix that ages says so, by word, age and shape."""

import time

from tests.end_to_end.canvas import FIRST_CREW, FIRST_LINE
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
    eventually(lambda: commander.shape(FIRST_LINE) == "square")
    noted = commander.noted("QUIET")
    assert list(noted) == ["Live", "Stale", "Lost"]
    assert noted["Stale"] in {"6 s", "7 s"}
    assert noted["Lost"] in {"12 s", "13 s"}
    assert commander.counts == "1 responder 0 live 0 stale 1 lost"
    commander.shows_the_next("lost")
    eventually(lambda: commander.selected == "quiet")

    heard(post, incident, step(time.time(), "quiet", [0, 0, 0]))
    commander.sees("QUIET", "Live")


def test_air_that_was_told_long_ago_is_said_to_be_of_then_though_its_bearer_is_live(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    told = {"kind": "status", "t": T0, "node": "walker", "air_bar": 180}
    heard(post, incident, base(T0), responder(T0, "walker", "A", [3, 3, 0]), told)
    commander.opens(server.url, incident)
    eventually(lambda: commander.board()["WALKER"].air == "air 180 bar")
    heard(post, incident, step(T0 + 300, "walker", [1, 0, 0]))
    eventually(lambda: commander.board()["WALKER"].air == "air was 180 bar, 5 min ago")
    assert commander.board()["WALKER"].status == "Was live"
    assert commander.cut_off() == []
    heard(post, incident, told | {"t": T0 + 301, "air_bar": 90})
    eventually(lambda: commander.board()["WALKER"].air == "90 bar, turn back")


def test_who_is_lost_because_the_clock_of_the_unit_is_wrong_has_that_on_the_card(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident(clock="live")
    now = time.time()
    unset = responder(5.0, "unset", "A", [3, 3, 0])
    heard(post, incident, unset, base(now), responder(now, "set", "A", [5, 3, 0]))
    heard(post, incident, step(9.0, "unset", [1, 0, 0]))
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    commander.sees("UNSET", "Lost")
    assert (commander.cut_off(), commander.off_the_screen) == ([], [])
    commander.selects("unset")

    def is_told_why() -> bool:
        heard(post, incident, step(time.time(), "set", [0.1, 0, 0]))
        return "60 s late" in commander.card

    eventually(is_told_why, every_s=0.5)


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
    assert commander.counts == "1 responder 1 was live 0 stale 0 lost"


def test_who_falls_silent_together_leads_to_the_gateway_and_not_to_each_of_them(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident(clock="live", settings={"stale_after_s": 3, "lost_after_s": 600})
    now = time.time()
    first = [responder(now, f"e{at}", "E7", [2 * at, 2, 0]) for at in range(2)]
    second = [responder(now, f"l{at}", "L3", [2 * at, 6, 0]) for at in range(2)]
    heard(post, incident, base(now), *first, *second)
    commander.opens(server.url, incident)

    def only_the_first_are_heard() -> bool:
        heard(post, incident, step(time.time(), "e0", [0.1, 0, 0]))
        return bool(commander.fallen_silent)

    eventually(only_the_first_are_heard, every_s=0.5)
    assert commander.fallen_silent[0].startswith("Nobody of L3 has been heard for")
    eventually(lambda: commander.fallen_silent[0].startswith("Nobody has been heard for"))
    assert commander.fallen_silent[0].endswith("look to the gateways and their links.")
    heard(post, incident, *(step(time.time(), name, [0.1, 0, 0]) for name in ("e0", "e1", "l0", "l1")))
    eventually(lambda: commander.fallen_silent == [])
