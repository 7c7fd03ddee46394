"""Low air is noticed at once, with its age, and cries no wolf."""

import time
from pathlib import Path

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import Reading, alarm, base, heard, recorded, responder, step
from tests.running import Post, Server, eventually

pytestmark = pytest.mark.usefixtures("nothing_left_open")

T0 = 1_763_712_345.0


def air(t: float, node: str, bar: float) -> Reading:
    """The pressure that a unit reports."""
    return {"kind": "status", "t": t, "node": node, "air_bar": bar}


def two_inside(post: Post, t: float, clock: str, **settings: float) -> str:
    """An incident in which two have entered with full cylinders."""
    incident = post.open_incident(clock=clock, settings=settings)
    crew = [responder(t, "ff1", "A", [2, 2, 0]), responder(t, "ff2", "A", [6, 2, 0])]
    heard(post, incident, base(t), *crew, air(t, "ff1", 300), air(t, "ff2", 300))
    return incident


def test_low_air_is_told_on_top_within_a_second_and_the_way_leads_to_its_bearer(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = two_inside(post, time.time(), "live")
    commander.opens(server.url, incident)
    assert commander.board()["FF1"].air == "air 300 bar"
    heard(post, incident, air(time.time(), "ff1", 170))
    eventually(lambda: commander.board()["FF1"].air == "170 bar, turn back")
    assert commander.low_on_air == []

    heard(post, incident, air(time.time(), "ff1", 58))
    eventually(lambda: commander.low_on_air, within_s=1)
    assert commander.low_air_is_loud
    assert commander.low_on_air[0].startswith("FF1 58 bar")
    assert commander.spoken_of_air == "Low air: FF1."
    assert commander.board()["FF1"].air == "LOW AIR 58 bar"
    eventually(lambda: "3 s ago" in commander.low_on_air[0])
    commander.goes_to_who_is_low_on_air()
    eventually(lambda: commander.selected == "ff1")
    assert "Turn back at 180 bar" in " ".join(commander.card.split())


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (768, 1024)])
def test_pressure_that_was_told_long_ago_fits_its_line_with_its_age_and_that_it_is_time_to_turn_back(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    incident = two_inside(post, T0, "recorded")
    heard(post, incident, air(T0 + 1, "ff1", 178), step(T0 + 754, "ff1", [1, 0, 0]))
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: commander.board()["FF1"].air == "was 178 bar, 12 min ago, turn back")
    commander.selects("ff1")
    assert (commander.cut_off(), commander.off_the_screen) == ([], [])
    assert commander.slides_sideways == []


def test_low_air_that_was_seen_is_quiet_until_it_is_somebody_elses_and_another_cylinder_ends_it(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = two_inside(post, T0, "recorded")
    heard(post, incident, air(T0 + 1, "ff1", 58))
    commander.opens(server.url, incident)
    eventually(lambda: commander.low_air_is_loud)
    commander.has_seen_the_low_air()
    eventually(lambda: not commander.low_air_is_loud)
    # A report that wavers about the limit is neither good news nor bad.
    heard(post, incident, air(T0 + 2, "ff1", 62))
    eventually(lambda: commander.low_on_air[0].startswith("FF1 62 bar"))
    assert not commander.low_air_is_loud

    heard(post, incident, air(T0 + 3, "ff2", 50))
    eventually(lambda: len(commander.low_on_air) == 2 and commander.low_air_is_loud)
    assert commander.low_on_air[0].startswith("FF2 50 bar")
    heard(post, incident, air(T0 + 4, "ff1", 290), air(T0 + 4, "ff2", 300))
    eventually(lambda: commander.low_on_air == [])
    assert commander.board()["FF1"].air == "air 290 bar"


def test_low_air_is_of_now_while_the_past_is_looked_at_and_of_nobody_once_it_is_over(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = two_inside(post, T0, "recorded", low_air_bar=100)
    heard(post, incident, step(T0 + 8, "ff1", [1, 0, 0]), air(T0 + 8, "ff1", 99))
    recorded(post, incident, T0 + 8)
    commander.opens(server.url, incident)
    eventually(lambda: commander.low_on_air)
    commander.scrubs_to(T0 + 2)
    eventually(lambda: commander.mode == "REPLAY" and commander.board()["FF1"].air == "air 300 bar")
    assert commander.low_on_air[0].startswith("FF1 99 bar")
    commander.goes_to_who_is_low_on_air()
    eventually(lambda: commander.mode == "RECORDED" and commander.selected == "ff1")
    assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200
    eventually(lambda: commander.mode == "CLOSED", within_s=15)
    assert commander.low_on_air == []
    assert commander.board()["FF1"].air == "LOW AIR 99 bar"


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768), (768, 1024), (390, 844)])
def test_however_many_are_low_on_air_fingers_in_gloves_meet_their_names_and_the_map_stays(
    server: Server, post: Post, commander: Commander, axe: Path, width: int, height: int
) -> None:
    incident = post.open_incident()
    crew = [responder(T0, f"ff{at}", "A", [2 * at, 2, 0]) for at in range(9)]
    crew[3]["callsign"] = "Hauptlöschgruppenführer Schwarzenberg-Wolkenstein"
    heard(post, incident, base(T0), *crew, *(air(T0, f"ff{at}", 40 + at) for at in range(9)))
    heard(post, incident, alarm(T0, "ff2"))
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: len(commander.low_on_air) == 9 and commander.banners)
    for _ in range(3):
        assert commander.faults_of_access(axe) == []
        commander.switches_theme()
    assert (commander.off_the_screen, commander.cut_off()) == ([], [])
    assert commander.low_air_too_small_for_gloves == []
    assert commander.map_height >= 0.2 * height
    commander.has_seen_the_low_air()
    eventually(lambda: not commander.low_air_is_loud)
    for _ in range(3):
        assert commander.faults_of_access(axe) == []
        commander.switches_theme()
