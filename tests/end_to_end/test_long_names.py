"""However long the names of incidents, storeys and people are, what stands beside them is read."""

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, base, heard, recorded, responder, step
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")

T0 = 1_763_712_345.0


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (768, 1024)])
@pytest.mark.parametrize("closed", [False, True], ids=["open", "closed"])
def test_however_long_the_name_of_an_incident_is_when_it_was_begun_is_read(
    server: Server, post: Post, commander: Commander, width: int, height: int, closed: bool
) -> None:
    incident = post.open_incident("Third alarm, office block Hauptstrasse 12 to 18, north wing and courtyard")
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    recorded(post, incident, T0)
    if closed:
        assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: "Nov 21, 2025" in commander.incident_begun)
    assert commander.incident_begun.startswith("closed") == closed
    assert not commander.name_and_begin_overlap
    assert commander.top_bar_height < 60


def test_however_short_the_name_of_an_incident_is_when_it_was_begun_is_read_on_a_wide_screen(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident("Fire")
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    recorded(post, incident, T0)
    assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200
    commander.sits_at(1920, 1080)
    commander.opens(server.url, incident)
    eventually(lambda: "Nov 21, 2025, " in commander.incident_begun)
    assert not commander.name_and_begin_overlap


def test_however_long_a_name_is_the_status_and_the_age_are_seen(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    names = ["Hauptlöschgruppenführer Schwarzenberg-Wolkenstein", "x" * 64, "الإطفائي محمد عبد الرحمن"]
    crew = [
        responder(T0, f"ff{at}", "A", [4 * at, 2, 0]) | {"callsign": name} for at, name in enumerate(names)
    ]
    gone = responder(T0, "gone", "A", [0, 4, 0]) | {"callsign": "Tower 5 E"}
    heard(post, incident, base(T0), *crew, gone, alarm(T0, "ff0"))
    heard(post, incident, {"kind": "retire", "t": T0 + 1, "node": "gone"}, step(T0 + 900, "ff0", [0, 0, 0]))
    commander.sits_at_a_tablet()
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.board()) == 4 and commander.board()["Tower 5 E"].age_s > 600)
    assert (commander.off_the_screen, commander.cut_off()) == ([], [])
    assert commander.narrowest_name > 75
    for node in ("ff0", "ff1"):
        commander.selects(node)
        commander.closes_the_card()


@pytest.mark.parametrize(("width", "height"), [(1180, 820), (820, 1180), (390, 844)])
def test_people_of_one_vehicle_whose_names_begin_alike_are_told_apart_on_the_board_and_low_on_air(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    incident = post.open_incident()
    names = [f"Löschgruppenfahrzeug-1-Atemschutztrupp-{number}" for number in (1, 2)]
    crew = [
        responder(T0, f"ff{at}", "A", [4 * at, 2, 0]) | {"callsign": name} for at, name in enumerate(names)
    ]
    air = [{"kind": "status", "t": T0, "node": f"ff{at}", "air_bar": 30.0} for at in range(2)]
    heard(post, incident, base(T0), *crew, *air)
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.board()) == 2)
    assert set(commander.board()) == set(names)
    assert commander.name_ends_seen == ["utztrupp-1", "utztrupp-2"]
    assert (commander.off_the_screen, commander.cut_off()) == ([], [])
    eventually(lambda: len(commander.low_on_air) == 2)
    for number in (1, 2):
        assert any(f"…utztrupp-{number}" in told for told in commander.low_on_air)


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (390, 844)])
def test_however_long_the_name_of_a_storey_is_how_sure_it_is_and_the_map_are_seen(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    levels = [
        {"level": 0, "name": "Ground floor and mezzanine, east wing", "up_m": 0.0},
        {"level": 1, "name": "First", "up_m": 3.0},
    ]
    incident = post.open_incident(levels=levels)
    between = [responder(T0, f"ff{at}", "A", [4 * at, 2, 1.3]) for at in range(3)]
    heard(post, incident, base(T0), *between)
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    assert {" %" in row.level for row in commander.board().values()} == {True}
    assert (commander.off_the_screen, commander.cut_off()) == ([], [])
    if width > 520:
        assert commander.storeys_end < 0.4 * commander.map_width


def test_a_caller_whose_name_is_one_long_word_is_read_beside_the_button_that_answers_on_a_phone(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    leader = responder(T0, "ff1", "A", [2, 2, 0]) | {"callsign": "Angriffstruppführer"}
    heard(post, incident, base(T0), leader, alarm(T0, "ff1"))
    commander.sits_at(390, 844)
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.banners) == 1)
    assert commander.caller_is_clear_of_the_button
