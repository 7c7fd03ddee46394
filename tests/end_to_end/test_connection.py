"""The screen says that the server is gone, and comes back by itself."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.end_to_end.canvas import FIRST_CREW
from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, base, heard, responder, step
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
    incident = post.open_incident(clock="live", settings={"stale_after_s": 4, "lost_after_s": 60})
    now = time.time()
    heard(post, incident, base(now), responder(now, "walker", "A", [2, 2, 0]))
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
    eventually(lambda: commander.colour(FIRST_CREW).x > before.x + 10, within_s=5)
    post.http.close()


def test_an_estimator_that_could_not_go_on_is_told_apart_from_silent_crews(
    own_server: Server, commander: Commander
) -> None:
    post = Post(own_server.url)
    incident = post.open_incident(clock="live")
    now = time.time()
    heard(post, incident, base(now), responder(now, "walker", "A", [2, 2, 0]))
    commander.opens(own_server.url, incident)
    assert not commander.stands_still

    commander.hears_that_the_estimator_broke()
    commander.reloads()
    eventually(lambda: commander.stands_still)
    assert not commander.connection_lost
    assert commander.mode == "NOT LIVE"
    commander.sees("WALKER", "Stale", within_s=3)
    post.http.close()


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
