"""The screen says that the server is gone, and comes back by itself."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.end_to_end.commander import FIRST_CREW, Commander
from tests.end_to_end.scene import base, heard, responder, step
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
    # No word comes from the server: the screen ages its fixes itself.
    commander.sees("WALKER", "Stale", within_s=8)
    assert commander.board()["WALKER"].age_s >= 4
    assert commander.shape(FIRST_CREW) == "diamond"

    own_server.start().until_it_computes()
    eventually(lambda: not commander.connection_lost, within_s=15)
    heard(post, incident, step(time.time(), "walker", [1.0, 0, 0]))
    commander.sees("WALKER", "Live")
    eventually(lambda: commander.colour(FIRST_CREW).x > before.x + 10, within_s=5)
    post.http.close()
