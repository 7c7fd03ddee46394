"""On every screen that a commander has, the timeline is one row, and an alarm takes nobody's map away."""

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, base, heard, recorded, responder, step
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")

T0 = 1_763_712_345.0
LONG_S = 2 * 3600 + 5
LUNAR = (
    "Location: second floor, corridor side of room S4, low wall collapsed. Unit: Ladder 3, L3-2. "
    "Name: Novak. Assignment: primary search. Resources: two rescuers and a cutter, air below 150 bar."
)


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (768, 1024)])
@pytest.mark.parametrize("closed", [False, True], ids=["live", "closed"])
def test_the_timeline_lies_in_one_row_also_hours_back_in_a_replay(
    server: Server, post: Post, commander: Commander, width: int, height: int, closed: bool
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    heard(post, incident, step(T0 + LONG_S, "walker", [1, 0, 0]))
    recorded(post, incident, T0 + LONG_S)
    if closed:
        assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    assert (commander.timeline_rows, commander.timeline_overlaps) == (1, [])

    commander.scrubs_to(T0 + 2)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    assert (commander.timeline_rows, commander.timeline_overlaps) == (1, [])
    commander.plays()
    assert (commander.timeline_rows, commander.timeline_overlaps) == (1, [])
    assert commander.off_the_screen == []


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (768, 1024)])
def test_what_a_mayday_says_leaves_the_map_its_room(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    incident = post.open_incident()
    heard(
        post,
        incident,
        base(T0),
        responder(T0, "walker", "A", [2, 2, 0]),
        alarm(T0, "walker", text=LUNAR),
        alarm(T0, "walker", kind="pass", text="no movement for 30 s"),
    )
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 2)
    assert LUNAR in commander.banners[0]
    assert commander.map_height >= 0.28 * height
    assert commander.off_the_screen == []


def test_however_many_call_for_help_the_map_stays(server: Server, post: Post, commander: Commander) -> None:
    incident = post.open_incident()
    callers = [f"ff{number}" for number in range(8)]
    heard(
        post,
        incident,
        base(T0),
        *(responder(T0, name, "A", [2 * at, 2, 0]) for at, name in enumerate(callers)),
        *(alarm(T0 + at, name, text=LUNAR) for at, name in enumerate(callers)),
    )
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 8)
    assert commander.map_height >= 0.2 * 768
