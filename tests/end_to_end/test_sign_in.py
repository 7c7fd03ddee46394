"""Who is let in, and what a session that ends in the middle of an incident leaves in view."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, heard, one_inside
from tests.running import Post, Server, eventually


class Guarded(Server):
    """A server that asks for the access token."""

    access = ()

    @property
    def token(self) -> str:
        """What it asks for."""
        return (self.data / "access-token").read_text().strip()


@pytest.fixture
def guarded(tmp_path: Path) -> Iterator[Guarded]:
    """One of them at work."""
    server = Guarded(tmp_path / "data").start()
    server.until_it_computes()
    yield server
    server.stop()


def test_a_session_that_ends_covers_no_alarm_and_goes_on_once_signed_in(
    guarded: Guarded, commander: Commander
) -> None:
    post = Post(guarded.url)
    post.http.headers["Authorization"] = f"Bearer {guarded.token}"
    incident = one_inside(post)
    commander.sits_at_a_tablet()
    commander.page.goto(f"{guarded.url}/#incident={incident}&token={guarded.token}")
    eventually(commander.board)

    commander.page.context.clear_cookies()
    eventually(lambda: commander.is_asked_to_sign_in, within_s=20)
    heard(post, incident, alarm(time.time(), "walker"))
    eventually(lambda: commander.banners)
    commander.goes_to_the_alarm()
    assert commander.selected == "walker"

    commander.signs_in(guarded.token)
    eventually(lambda: not commander.is_asked_to_sign_in)
    commander.acknowledges()
    eventually(lambda: any("acknowledged" in banner for banner in commander.banners))
    post.http.close()
