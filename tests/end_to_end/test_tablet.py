"""On every screen of a commander, top bar and timeline take one row each, and alarms leave the map room."""

import pytest

from tests.end_to_end.canvas import FIRST_CREW
from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, base, heard, recorded, responder, step
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")

T0 = 1_763_712_345.0
LONG_S = 2 * 3600 + 5
STOREYS = ["Ground", "First", "Second"]
LUNAR = (
    "Location: second floor, corridor side of room S4, low wall collapsed. Unit: Ladder 3, L3-2. "
    "Name: Novak. Assignment: primary search. Resources: two rescuers and a cutter, air below 150 bar."
)


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (768, 1024)])
@pytest.mark.parametrize("closed", [False, True], ids=["live", "closed"])
def test_top_bar_and_timeline_lie_in_one_row_each_also_hours_back_in_a_replay(
    server: Server, post: Post, commander: Commander, width: int, height: int, closed: bool
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    crew = [responder(T0 + LONG_S, f"ff{number}", "A", [number, 5, 0]) for number in range(40)]
    heard(post, incident, step(T0 + LONG_S, "walker", [1, 0, 0]), *crew)
    recorded(post, incident, T0 + LONG_S)
    if closed:
        assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    assert (commander.timeline_rows, commander.timeline_overlaps) == (1, [])
    assert commander.top_bar_height < 60

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
        responder(T0, "second", "A", [4, 2, 0]),
        alarm(T0, "walker", text=LUNAR),
        alarm(T0, "second", kind="pass", text="no movement for 30 s"),
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


@pytest.mark.parametrize(("width", "height"), [(1366, 768), (1024, 768), (800, 1280), (390, 844)])
def test_calls_low_air_and_calls_elsewhere_at_once_are_all_told_and_leave_the_map_its_room(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    for name in ("Mill", "Barn", "Ship"):
        heard(post, post.open_incident(name), responder(T0, "far", "F", [1, 1, 0]), alarm(T0, "far"))
    incident = post.open_incident()
    crew = [f"ff{at}" for at in range(8)]
    heard(
        post,
        incident,
        base(T0),
        *(responder(T0, name, "A", [4 * at, 3, 0]) for at, name in enumerate(crew)),
        *({"kind": "status", "t": T0, "node": name, "air_bar": 40} for name in crew[:5]),
        *(alarm(T0, name, text=LUNAR) for name in crew[5:]),
    )
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 3 and len(commander.low_on_air) == 5)
    eventually(lambda: commander.calls_elsewhere)
    assert commander.map_height >= 0.17 * height
    assert (commander.off_the_screen, commander.told_out_of_sight) == ([], [])
    assert "2 more incidents" in commander.words_of_elsewhere
    assert commander.low_air_heading == "LOW AIR 5"


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (1366, 1024)])
def test_every_storey_of_a_tower_is_seen_while_somebody_calls_and_hides_nobody(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    levels = [{"level": at, "name": str(at) if at else "G", "up_m": 3.2 * at} for at in range(-1, 11)]
    incident = post.open_incident(levels=levels)
    crew = [responder(T0, "west", "A", [-30, 2, 0], sigma_m=0.1), responder(T0, "east", "B", [30, 2, 3])]
    heard(post, incident, base(T0), *crew, alarm(T0, "east", text=LUNAR))
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: commander.banners)
    assert commander.storeys_out_of_sight == []
    assert commander.off_the_screen == []
    eventually(lambda: commander.settled_mark(FIRST_CREW).left > commander.storeys_end)


@pytest.mark.parametrize(("width", "height"), [(1366, 768), (1024, 768), (800, 1280)])
def test_the_storeys_of_a_high_tower_hide_nobody_and_those_where_somebody_is_are_seen(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    levels = [
        {"level": at, "name": f"Floor {at}" if at >= 0 else f"Basement {-at}", "up_m": 3.2 * at}
        for at in range(-3, 41)
    ]
    incident = post.open_incident(levels=levels)
    west, east = responder(T0, "west", "A", [-30, 2, 0], sigma_m=0.1), responder(T0, "e", "B", [30, 2, 96])
    others = [responder(T0, f"ff{at}", "B", [at, 2, 9.6 * at], sigma_m=0.1) for at in range(1, 6)]
    heard(post, incident, base(T0), west, east, *others, alarm(T0, "e", text=LUNAR))
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: commander.banners)
    occupied = ["All", *(f"Floor {at}" for at in (30, 15, 12, 9, 6, 3, 0))]
    eventually(lambda: commander.storeys == occupied)
    assert commander.storeys_out_of_sight == []
    assert commander.off_the_screen == []
    eventually(lambda: commander.settled_mark(FIRST_CREW).left > commander.storeys_end)

    commander.asks_for_the_empty_storeys()
    eventually(lambda: len(commander.storeys) == 45)
    assert commander.storeys_end < width / 3
    commander.chooses_storey("Floor 40")
    assert commander.storey == "Floor 40"
    commander.asks_for_the_empty_storeys()
    eventually(lambda: commander.storeys == ["All", "Floor 40", *occupied[1:]])


def test_who_asks_why_somebody_is_here_keeps_the_alarms_in_view(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    crew = [f"ff{number}" for number in range(12)]
    heard(
        post,
        incident,
        base(T0),
        *(responder(T0, name, "A", [2 * at, 2, 0]) for at, name in enumerate(crew)),
        alarm(T0, "ff3", text=LUNAR),
    )
    heard(post, incident, *(step(T0 + 2, name, [0.5, 0, 0]) for name in crew))
    recorded(post, incident, T0 + 2)
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    commander.selects("ff1")
    commander.asks_why_here()
    assert commander.slid_px == 0
    assert commander.answer_fills_the_card
    assert commander.slides_sideways == []


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768)])
def test_enlarged_to_twice_its_size_the_screen_loses_nothing(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    incident = post.open_incident()
    calls = [alarm(T0, "walker", text=LUNAR), alarm(T0, "second", kind="pass")]
    crew = [responder(T0, name, "A", [2 * at, 2, 0]) for at, name in enumerate(("walker", "second"))]
    heard(post, incident, base(T0), *crew, *calls)
    commander.sits_at(width // 2, height // 2)
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 2)
    assert commander.map_height >= 300
    assert commander.off_the_screen == []
    assert commander.scrolls_to_the_end()


@pytest.mark.parametrize("times", [1.5, 2])
@pytest.mark.parametrize(("width", "height"), [(1366, 1024), (1024, 768)])
def test_text_grows_as_the_browser_is_set_and_pushes_nothing_off_the_screen(
    server: Server, post: Post, commander: Commander, width: int, height: int, times: float
) -> None:
    incident = post.open_incident()
    calls = [alarm(T0, "walker", text=LUNAR), alarm(T0, "second", kind="pass")]
    crew = [responder(T0, name, "A", [2 * at, 2, 0]) for at, name in enumerate(("walker", "second"))]
    heard(post, incident, base(T0), *crew, *calls)
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    usual = commander.text_px
    commander.reads_with_larger_text(times)
    commander.reloads()
    eventually(lambda: len(commander.banners) == 2)
    assert commander.text_px["page"] == times * usual["page"]
    assert commander.text_px["board"] == times * usual["board"]
    assert commander.text_px["clock"] >= 0.8 * times * usual["clock"]
    assert commander.map_height >= 0.2 * height
    assert (commander.off_the_screen, commander.cut_off()) == ([], [])


@pytest.mark.parametrize("called", [False, True], ids=["calm", "mayday"])
def test_a_crew_leader_with_a_phone_sees_the_map_the_counts_and_every_storey(
    server: Server, post: Post, commander: Commander, called: bool
) -> None:
    levels = [{"level": at, "name": f"{name} floor", "up_m": 3.0 * at} for at, name in enumerate(STOREYS)]
    incident = post.open_incident("A fire in a house with a long name", levels=levels)
    crew = [responder(T0, f"ff{at}", "A", [2 * at, 2, 0]) for at in range(4)]
    calls = [alarm(T0, "ff1", text=LUNAR)] if called else []
    heard(post, incident, base(T0), *crew, *calls)
    heard(post, incident, step(T0 + 30, "ff0", [1, 0, 0]))
    recorded(post, incident, T0 + 30)
    commander.sits_at(390, 844)
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == int(called))
    assert (commander.off_the_screen, commander.cut_off()) == ([], [])
    assert commander.top_bar_height < 110
    assert commander.timeline_rows == 2
    assert commander.map_height >= (150 if called else 300)
    assert commander.cut_off_counts == []
    assert commander.too_small_on_a_phone == []
