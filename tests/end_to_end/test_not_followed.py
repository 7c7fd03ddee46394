"""Who is heard and has no dot is told of, with the reason."""

import itertools
import time
from pathlib import Path

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import base, heard, one_inside, responder, step
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")


def test_whose_clock_is_wrong_is_told_of_though_nothing_of_it_is_used_until_the_clock_is_set(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    commander.opens(server.url, incident)
    assert commander.not_followed == []
    now = time.time()
    ahead = [responder(now + 900, "r1", "Rescue", [4, 2, 0]), step(now + 900, "r1", [1, 0, 0])]
    assert post.telemetry(incident, "ahead", ahead, gateway="engine-9")["accepted"] == 0
    eventually(lambda: commander.not_followed, within_s=5)
    assert commander.not_followed[0].startswith("R1: clock 15 min ahead: set it Heard")
    assert commander.not_followed[0].endswith("ago by engine-9")
    # It is no responder of whom anything is known, and no row that ages.
    assert set(commander.board()) == {"WALKER"}

    heard(post, incident, responder(time.time(), "r1", "Rescue", [4, 2, 0]))
    eventually(lambda: "R1" in commander.board() and commander.not_followed == [])


def test_whose_readings_are_not_understood_or_come_too_late_is_told_of(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    now = time.time()
    post.telemetry(incident, "bad", [{"kind": "displacement", "t": now, "node": "r 1", "delta_m": [1, 0, 0]}])
    post.telemetry(incident, "late", [step(now - 900, "r2", [1, 0, 0])])
    heard(post, incident, step(now + 1, "walker", [0.1, 0, 0]))
    commander.opens(server.url, incident)

    def told() -> bool:
        heard(post, incident, step(time.time(), "walker", [0.1, 0, 0]))
        return len(commander.not_followed) == 2

    eventually(told, every_s=0.5)
    first, second = commander.not_followed
    assert first.startswith("r 1: readings not understood: `node`")
    assert second.startswith("r2: 1 reading so far came more than 60 s late")


def test_whose_fixes_are_latitudes_is_told_of_until_the_incident_has_an_origin(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    commander.opens(server.url, incident)

    def at_the_door(t: float, node: str) -> dict[str, object]:
        return {"kind": "position", "t": t, "node": node, "wgs84": [48.0, 11.0, 500.0]}

    def told() -> bool:
        now = time.time()
        heard(post, incident, step(now, "walker", [0.1, 0, 0]), at_the_door(now, "r3"))
        return bool(commander.not_followed)

    eventually(told, every_s=0.5)
    assert commander.not_followed[0].startswith("r3: a WGS84 fix cannot be fused: the incident has no origin")
    assert set(commander.board()) == {"WALKER"}

    origin = {"lat": 48.0, "lon": 11.0, "hae": 500.0}
    assert post.http.patch(f"/incidents/{incident}", json={"origin": origin}).status_code == 200
    eventually(lambda: "r3" in commander.board() and commander.not_followed == [])


def test_who_was_followed_until_the_clock_jumped_is_told_of_with_the_dot_that_is_old(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident(clock="live", settings={"stale_after_s": 2, "lost_after_s": 60})
    now = time.time()
    heard(post, incident, base(now), responder(now, "ff1", "A", [2, 2, 0]))
    commander.opens(server.url, incident)
    post.telemetry(incident, "ahead", [step(time.time() + 7200, "ff1", [1, 0, 0])])
    commander.sees("FF1", "Stale")
    eventually(lambda: commander.not_followed)
    assert commander.not_followed[0].startswith("FF1: clock 2 h ahead")
    commander.selects("ff1")
    eventually(lambda: "not used: clock 2 h ahead" in commander.card)


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (768, 1024)])
def test_however_far_the_board_is_turned_who_is_not_followed_stays_in_view(
    server: Server, post: Post, commander: Commander, axe: Path, width: int, height: int
) -> None:
    incident = post.open_incident(clock="live")
    now = time.time()
    crew = [responder(now, f"ff{at}", "A", [at, 2, 0]) for at in range(30)]
    heard(post, incident, base(now), *crew)
    made_up = [step(now + 600, "x" * 60 + str(at), [1, 0, 0]) for at in range(20)]
    post.telemetry(incident, "ahead", made_up)
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: commander.not_followed)
    commander.selects("ff29")
    eventually(lambda: commander.is_on_the_board("ff29"))
    assert commander.not_followed_in_view
    assert commander.off_the_screen == []
    for _ in range(3):
        assert commander.faults_of_access(axe) == []
        commander.switches_theme()


def test_a_gateway_whose_clock_is_an_hour_behind_is_told_of_with_what_to_do_until_it_is_set(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident(clock="live")
    now = time.time()
    heard(post, incident, base(now), responder(now, "right", "A", [2, 2, 0]))
    batches = itertools.count()

    def posts(behind_s: float) -> None:
        t = time.time() - behind_s
        slow = [responder(t, "slow", "B", [5, 2, 0]), step(t, "slow", [0.1, 0, 0])]
        post.telemetry(incident, f"slow-{next(batches)}", slow, gateway="ladder-3")

    def told() -> str:
        posts(3600)
        return commander.clocks_behind

    posts(3600)
    commander.opens(server.url, incident)
    eventually(told, within_s=40, every_s=1)
    assert commander.clocks_behind.startswith(
        "Clock of gateway ladder-3 is 60 min behind: set it. Until then"
    )
    posts(0)
    commander.sees("SLOW", "Live")
    eventually(lambda: not commander.clocks_behind, within_s=5)
