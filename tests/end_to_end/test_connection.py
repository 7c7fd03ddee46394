"""The screen says that the server is gone, and comes back by itself."""

import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.end_to_end.canvas import FIRST_CREW
from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, base, heard, one_inside, recorded, responder, step
from tests.running import Post, Server, eventually, running


@pytest.fixture
def own_server(tmp_path: Path) -> Iterator[Server]:
    """A server that this test may kill."""
    with running(tmp_path / "data") as server:
        yield server.until_it_computes()


def test_a_screen_whose_server_was_killed_says_so_ages_and_reconnects_by_itself(
    own_server: Server, commander: Commander
) -> None:
    post = Post(own_server.url)
    incident = one_inside(post, settings={"stale_after_s": 4, "lost_after_s": 60})
    commander.opens(own_server.url, incident)
    commander.sees("WALKER", "Live")
    assert not commander.connection_lost
    before = commander.settled_mark(FIRST_CREW)

    own_server.kill_web()
    eventually(lambda: commander.connection_lost, within_s=6)
    # Nothing is called live that is not heard, and the screen ages its fixes itself.
    commander.sees("WALKER", "Stale", within_s=1)
    assert commander.mode == "NOT LIVE"
    assert commander.newest_button == "Not live"
    eventually(lambda: commander.board()["WALKER"].age_s >= 4, within_s=8)
    assert commander.shape(FIRST_CREW) == "diamond"

    own_server.start().until_it_computes()
    eventually(lambda: not commander.connection_lost, within_s=15)
    heard(post, incident, step(time.time(), "walker", [1.0, 0, 0]))
    commander.sees("WALKER", "Live")
    assert commander.mode == "LIVE"
    eventually(lambda: commander.colour(FIRST_CREW).x > before.x + 10)
    post.http.close()


def test_an_estimator_that_could_not_go_on_is_told_apart_from_silent_crews(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    commander.opens(server.url, incident)
    assert not commander.stands_still

    commander.hears_that_the_estimator_broke()
    commander.reloads()
    eventually(lambda: commander.stands_still)
    assert not commander.connection_lost
    assert commander.mode == "NOT LIVE"
    commander.sees("WALKER", "Stale", within_s=3)


def test_what_was_reported_and_no_worker_took_in_is_not_passed_over_in_silence(
    tmp_path: Path, commander: Commander
) -> None:
    with running(tmp_path / "data", "--no-worker") as server:
        post = Post(server.url)
        incident = post.open_incident(clock="live")
        now = time.time()
        post.telemetry(incident, "b1", [responder(now, "walker", "A", [2, 2, 0]), alarm(now, "walker")])
        commander.page.goto(f"{server.url}/#incident={incident}")
        eventually(lambda: commander.is_behind)
        assert (commander.mode, commander.newest_button) == ("NOT LIVE", "Not live")
        # That there is nobody must not be read out of a picture that has nobody yet.
        assert "responder" not in commander.counts
        assert commander.board_words == "Not known yet who is there."
        post.http.close()


def test_a_tablet_that_wakes_up_calls_nothing_live_before_it_has_heard_the_server(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    commander.opens(server.url, incident)
    assert commander.mode == "LIVE"
    server_answers = commander.sleeps(600)
    eventually(lambda: "10 min" in commander.words_of_the_loss)
    server_answers()
    eventually(lambda: commander.mode == "LIVE" and not commander.connection_lost)


def test_on_a_tablet_a_lost_connection_pushes_nothing_off_the_screen_and_leaves_no_trace(
    own_server: Server, commander: Commander
) -> None:
    post = Post(own_server.url)
    incident = post.open_incident("A fire in a house with a long name", clock="live")
    now = time.time()
    heard(post, incident, base(now), responder(now, "walker", "A", [2, 2, 0]), alarm(now, "walker"))
    commander.sits_at_a_tablet()
    commander.opens(own_server.url, incident)
    eventually(lambda: commander.banners)
    assert commander.off_the_screen == []

    own_server.kill_web()
    eventually(lambda: commander.connection_lost, within_s=6)
    assert commander.off_the_screen == []
    commander.acknowledges()
    eventually(lambda: "Not sent" in commander.alarm_words)
    assert commander.off_the_screen == []

    own_server.start().until_it_computes()
    eventually(lambda: not commander.connection_lost, within_s=15)
    commander.acknowledges()
    eventually(lambda: "acknowledged" in commander.banners[0])
    assert commander.trouble == ""
    assert commander.off_the_screen == []
    post.http.close()


def test_over_a_slow_link_who_is_there_comes_before_where_they_have_been(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    let_through = commander.waits_for_pictures()
    commander.page.goto(f"{server.url}/#incident={incident}")
    eventually(lambda: commander.incident)
    commander.page.wait_for_timeout(1000)
    assert not commander.has_asked_for(f"/incidents/{incident}/tracks")
    assert not commander.has_asked_for(f"/incidents/{incident}/log")

    let_through()
    eventually(commander.board)
    eventually(lambda: commander.has_asked_for(f"/incidents/{incident}/tracks"))
    eventually(lambda: commander.has_asked_for(f"/incidents/{incident}/log"))


def test_a_replay_whose_server_is_gone_stands_still_shows_no_other_moment_and_goes_on_from_there(
    own_server: Server, commander: Commander
) -> None:
    post = Post(own_server.url)
    incident = post.open_incident()
    t = 1_763_712_345.0
    heard(post, incident, base(t), responder(t, "walker", "A", [2, 2, 0]))
    for second in range(1, 40):
        heard(post, incident, step(t + second, "walker", [0.5, 0, 0]))
    recorded(post, incident, t + 39)
    commander.opens(own_server.url, incident)
    commander.scrubs_to(t + 5)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    began = commander.clock
    commander.plays()
    eventually(lambda: commander.clock > began)

    own_server.kill_web()
    eventually(lambda: commander.connection_lost, within_s=6)
    # That of the past is lost a moment after that of the present, or before it.
    eventually(lambda: re.search(r"came ([2-9]|\d\d) s ago", commander.words_of_the_loss))
    stopped = commander.clock
    # While the loss is counted the past does not grow older: its last picture stays what it was.
    eventually(lambda: re.search(r"came ([5-9]|\d\d) s ago", commander.words_of_the_loss))
    assert commander.clock == stopped
    assert commander.board()["WALKER"].age_s <= 1
    commander.scrubs_to(t + 20)
    eventually(lambda: commander.board() == {})
    assert commander.clock == "–"

    own_server.start().until_it_computes()
    eventually(lambda: not commander.connection_lost, within_s=15)
    eventually(lambda: commander.board() and commander.clock > stopped)
    assert commander.board()["WALKER"].age_s <= 1
    post.http.close()
