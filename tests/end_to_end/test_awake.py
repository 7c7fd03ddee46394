"""A screen that may have to tell of an alarm does not go dark."""

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import one_inside
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")


def test_the_screen_is_kept_lit_until_its_incident_is_closed_also_after_it_was_dark(
    server: Server, post: Post, commander: Commander
) -> None:
    commander.may_go_dark()
    incident = one_inside(post)
    commander.opens(server.url, incident)
    eventually(lambda: commander.is_kept_lit)
    commander.goes_dark()
    eventually(lambda: commander.is_kept_lit)
    assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200
    eventually(lambda: not commander.is_kept_lit, within_s=20)
