"""A replay shows what was shown."""

import re
import time

import pytest

from tests.end_to_end.canvas import FIRST_CREW, FIRST_TRAIL, SECOND_CREW, Pixels
from tests.end_to_end.commander import BoardRow, Commander
from tests.end_to_end.scene import alarm, base, dropped, heard, recorded, responder, step
from tests.running import Post, Server, eventually

T0 = 1_763_712_345.0


def shown(commander: Commander) -> tuple[dict[str, BoardRow], list[Pixels]]:
    """What a commander takes from the screen: the words of the board, the marks on the map."""
    marks = [commander.settled_mark(colour) for colour in (FIRST_CREW, SECOND_CREW)]
    return commander.board(), marks


def alike(before: list[Pixels], after: list[Pixels]) -> bool:
    """Whether marks lie in the same places, to half a pixel."""
    return all(
        (one.x, one.y) == pytest.approx((other.x, other.y), abs=0.5)
        for one, other in zip(before, after, strict=True)
    )


def test_a_recording_in_which_there_is_nothing_yet_shows_no_time(
    server: Server, post: Post, commander: Commander
) -> None:
    post.open_incident("Empty")
    incident = post.open_incident("Begun")
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    commander.opens(server.url, incident)
    commander.chooses_incident("Empty")
    eventually(lambda: (commander.incident, commander.clock) == ("Empty", "–"))
    eventually(lambda: commander.counts.startswith("0 responders"))
    assert commander.clock == "–"


def test_a_time_of_another_day_is_told_with_its_day_also_in_the_list_of_incidents(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident("Loaded today")
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    recorded(post, incident, T0)
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    eventually(lambda: "2025" in commander.other_day)
    assert commander.top_bar_height < 60
    assert commander.other_day in commander.incident_begun

    now = time.time()
    today = post.open_incident("Today", clock="live")
    heard(post, today, base(now), responder(now, "walker", "A", [2, 2, 0]))
    commander.opens(server.url, today)
    eventually(lambda: commander.incident == "Today" and commander.board())
    assert commander.other_day == ""


def test_a_replay_shows_what_live_showed(server: Server, post: Post, commander: Commander) -> None:
    incident = post.open_incident()
    heard(
        post,
        incident,
        base(T0),
        responder(T0, "walker", "A", [-5, 2, 0]),
        responder(T0, "quiet", "B", [-5, -3, 0]),
    )
    commander.opens(server.url, incident)
    commander.turns_trails_off()
    commander.holds_the_map()
    for second in range(1, 6):
        heard(post, incident, step(T0 + second, "walker", [0.8, 0.4, 0]))
    eventually(lambda: commander.board()["QUIET"].age_s == 5)
    board, marks = shown(commander)
    assert board["QUIET"].status == "Was live"
    assert commander.mode == "RECORDED"
    noted = commander.clock

    for second in range(6, 21):
        heard(post, incident, step(T0 + second, "walker", [0.3, -0.4, 0]))
    eventually(lambda: commander.board()["QUIET"].age_s == 20)
    assert commander.board()["QUIET"].status == "Stale"
    newest = shown(commander)
    assert not alike(newest[1], marks)
    recorded(post, incident, T0 + 20)

    commander.scrubs_to(T0 + 5)
    eventually(lambda: commander.mode == "REPLAY")
    eventually(lambda: commander.clock == noted)
    eventually(lambda: commander.board() == board)
    eventually(lambda: alike(shown(commander)[1], marks))

    commander.plays()
    eventually(lambda: commander.clock > noted)
    eventually(lambda: commander.settled_mark(FIRST_CREW).x > marks[0].x + 3)

    commander.goes_back_to_live()
    eventually(lambda: commander.mode == "RECORDED")
    eventually(lambda: shown(commander)[0] == newest[0])
    assert alike(shown(commander)[1], newest[1])


def test_a_mayday_stands_before_a_commander_who_watches_the_past(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    heard(post, incident, step(T0 + 9, "walker", [1, 0, 0]))
    recorded(post, incident, T0 + 9)
    commander.opens(server.url, incident)
    commander.scrubs_to(T0 + 4)
    eventually(lambda: commander.mode == "REPLAY")
    assert commander.banners == []

    heard(post, incident, alarm(T0 + 10, "walker"))
    eventually(lambda: commander.banners)
    assert "MAYDAY WALKER" in commander.banners[0]
    assert commander.mode == "REPLAY"


def test_arrows_lead_from_event_to_event_and_nowhere_else(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    heard(post, incident, step(T0 + 5, "walker", [1, 0, 0]), alarm(T0 + 5, "walker"))
    heard(post, incident, step(T0 + 9, "walker", [1, 0, 0]))
    recorded(post, incident, T0 + 9)
    commander.opens(server.url, incident)
    eventually(lambda: commander.event_marks == ["MAYDAY WALKER"])
    eventually(lambda: commander.events_either_way == (True, False))
    commander.scrubs_to(T0 + 2)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    eventually(lambda: commander.events_either_way == (False, True))
    before = commander.clock
    commander.goes_to_the_next_event()
    eventually(lambda: commander.clock > before and commander.events_either_way == (False, False))
    eventually(lambda: commander.event == "MAYDAY WALKER")
    commander.scrubs_to(T0 + 2)
    eventually(lambda: commander.event == "")


def test_drops_are_marked_those_of_the_past_and_those_while_one_looks(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    heard(post, incident, step(T0 + 1, "walker", [1, 0, 0]), dropped(T0 + 1, "b1", "walker"))
    heard(post, incident, step(T0 + 3, "walker", [1, 0, 0]))
    commander.opens(server.url, incident)
    eventually(lambda: commander.event_marks == ["b1 dropped"])
    heard(post, incident, step(T0 + 30, "walker", [4, 0, 0]), dropped(T0 + 30, "b2", "walker"))
    eventually(lambda: commander.event_marks == ["b1 dropped", "b2 dropped"])


def test_an_alarm_says_where_the_responder_is_now_also_before_who_watches_the_past(
    server: Server, post: Post, commander: Commander
) -> None:
    levels = [{"level": 0, "name": "Ground", "up_m": 0.0}, {"level": 1, "name": "First", "up_m": 3.0}]
    incident = post.open_incident(levels=levels)
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0], sigma_m=0.2))
    for second in range(1, 9):
        heard(post, incident, step(T0 + second, "walker", [0.3, 0, 0.4]))
    recorded(post, incident, T0 + 8)
    commander.opens(server.url, incident)
    eventually(lambda: "First" in commander.board()["WALKER"].level)
    commander.scrubs_to(T0 + 1)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    assert "Ground" in commander.board()["WALKER"].level

    heard(post, incident, alarm(T0 + 10, "walker"))
    eventually(lambda: commander.banners)
    assert "First" in commander.banners[0]
    assert "Ground" in commander.board()["WALKER"].level

    commander.goes_to_the_alarm()
    eventually(lambda: commander.mode == "RECORDED")
    eventually(lambda: commander.selected == "walker" and "First" in commander.card)


def test_beside_the_past_as_it_was_shown_stands_what_is_known_now_and_never_beside_the_newest(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0], sigma_m=3.0))
    for second in range(1, 7):
        heard(post, incident, step(T0 + second, "walker", [1, 0, 0]))
    fix = {"kind": "position", "t": T0 + 6, "node": "walker", "position_m": [8, 6, 0], "sigma_m": [0.2] * 3}
    heard(post, incident, fix)
    heard(post, incident, step(T0 + 9, "walker", [1, 0, 0]))
    recorded(post, incident, T0 + 9)
    commander.opens(server.url, incident)
    assert not commander.can_compare
    commander.presses("k")
    commander.scrubs_to(T0 + 3)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    board = commander.board()
    assert (commander.known_now, commander.words_of_the_comparison) == ({}, "")

    commander.compares()
    eventually(lambda: "WALKER" in commander.known_now, within_s=120)
    assert re.fullmatch(r"Known now: [34]\.\d m off", commander.known_now["WALKER"])
    assert "as known now" in commander.words_of_the_comparison
    # What was shown then stays as it was.
    assert commander.board() == board

    commander.presses("b")
    eventually(lambda: commander.mode == "RECORDED")
    assert (commander.known_now, commander.can_compare) == ({}, False)
    commander.scrubs_to(T0 + 3)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    assert commander.known_now == {}


def test_long_before_the_end_of_an_incident_the_trail_leads_to_where_somebody_was(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [-10, 2, 0], sigma_m=0.1))
    heard(post, incident, *(step(T0 + second, "walker", [1.0, 0, 0]) for second in range(1, 41)))
    for later in (2700, 5400):
        heard(post, incident, step(T0 + later, "walker", [0, 0, 0]))
    recorded(post, incident, T0 + 5400)
    commander.follows_link(server.url, incident, t=T0 + 40)
    eventually(lambda: commander.mode == "REPLAY" and commander.board()["WALKER"].age_s == 0)
    mark = commander.settled_mark(FIRST_CREW)
    eventually(lambda: commander.colour(FIRST_TRAIL, tolerance=20).left < mark.left - 5 * mark.width)
    commander.turns_trails_off()
    eventually(lambda: commander.colour(FIRST_TRAIL, tolerance=20).left > mark.left - 3 * mark.width)
