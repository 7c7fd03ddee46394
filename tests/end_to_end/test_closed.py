"""A closed incident is not live, and says so."""

import time
from pathlib import Path

import pytest

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import alarm, base, heard, one_inside, recorded, responder, step
from tests.running import Post, Server, eventually, running

T0 = 1_763_712_345.0


def close(post: Post, incident: str) -> None:
    """Close an incident for good."""
    assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200


def test_a_screen_learns_that_its_incident_was_closed_and_its_clock_stands_still(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = one_inside(post)
    commander.opens(server.url, incident)
    assert commander.mode == "LIVE"
    close(post, incident)
    eventually(lambda: commander.mode == "CLOSED", within_s=15)
    assert commander.newest_button == "Closed"
    assert commander.counts == "1 responder 1 was live 0 stale 0 lost"
    assert commander.board()["WALKER"].status == "Was live"

    def stands_still() -> bool:
        before = commander.clock
        time.sleep(2.5)
        return commander.clock == before

    # The server's own clock of the incident ends with one of its next beats.
    eventually(stands_still, within_s=15)


def test_a_closed_incident_opens_as_closed_and_its_past_can_be_looked_at(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    heard(post, incident, step(T0 + 8, "walker", [1, 0, 0]))
    recorded(post, incident, T0 + 8)
    close(post, incident)
    commander.opens(server.url, incident)
    eventually(lambda: commander.mode == "CLOSED")
    commander.scrubs_to(T0 + 4)
    eventually(lambda: commander.mode == "REPLAY")
    assert commander.newest_button == "Back to the end"
    commander.goes_back_to_live()
    eventually(lambda: commander.mode == "CLOSED")


def test_nothing_is_advised_about_what_has_ended(server: Server, post: Post, commander: Commander) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    heard(post, incident, step(T0 + 8, "walker", [1, 0, 0]))
    recorded(post, incident, T0 + 8)
    commander.opens(server.url, incident)
    commander.selects("walker")
    commander.asks_why_here()
    eventually(lambda: commander.advice)
    close(post, incident)
    commander.reloads()
    eventually(lambda: commander.mode == "CLOSED")
    commander.asks_why_here()
    commander.page.wait_for_load_state("networkidle")
    assert commander.advice == ""
    assert not commander.has_asked_for("/advice")


def test_in_the_past_of_a_live_incident_the_board_says_who_was_live(
    server: Server, post: Post, commander: Commander
) -> None:
    incident, now = one_inside(post), time.time()
    commander.opens(server.url, incident)
    commander.sees("WALKER", "Live")
    eventually(lambda: time.time() > now + 3)
    heard(post, incident, step(time.time(), "walker", [1, 0, 0]))
    recorded(post, incident, now + 1)
    commander.scrubs_to(now + 1)
    eventually(lambda: commander.mode == "REPLAY" and commander.board())
    commander.sees("WALKER", "Was live")
    eventually(lambda: commander.counts == "1 responder 1 was live 0 stale 0 lost")
    commander.goes_back_to_live()
    commander.sees("WALKER", "Live")


def test_the_alarms_of_the_past_are_marked_though_they_are_over(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), responder(T0, "walker", "A", [2, 2, 0]))
    heard(post, incident, alarm(T0 + 2, "walker"), alarm(T0 + 4, "walker"))
    heard(
        post,
        incident,
        alarm(T0 + 5, "walker", state="acknowledged"),
        alarm(T0 + 6, "walker", state="cleared"),
    )
    heard(post, incident, step(T0 + 9, "walker", [1, 0, 0]))
    recorded(post, incident, T0 + 9)
    close(post, incident)
    commander.opens(server.url, incident)
    eventually(lambda: commander.event_marks == ["MAYDAY WALKER"])
    assert commander.banners == []


def test_of_a_closed_incident_that_is_not_worked_out_to_its_end_that_is_said(
    tmp_path: Path, commander: Commander
) -> None:
    with running(tmp_path / "data", "--no-worker") as server:
        post = Post(server.url)
        incident = post.open_incident()
        post.telemetry(
            incident, "all", [base(T0), responder(T0, "walker", "A", [2, 2, 0]), alarm(T0, "walker")]
        )
        close(post, incident)
        commander.page.goto(f"{server.url}/#incident={incident}")
        eventually(lambda: commander.mode == "CLOSED")
        eventually(lambda: "an alarm may be missing" in commander.not_the_end)

        server.stop()
        server.options.clear()
        server.start().until_it_computes()
        eventually(lambda: commander.banners and commander.board()["WALKER"].status == "Was live")
        eventually(lambda: commander.not_the_end == "")


@pytest.mark.parametrize(("width", "height"), [(1024, 768), (390, 844)])
def test_what_was_said_stands_under_who_called_also_when_it_is_over(
    server: Server, post: Post, commander: Commander, width: int, height: int
) -> None:
    incident = post.open_incident()
    caller = responder(T0, "caller", "A", [2, 2, 0]) | {"callsign": "Hauptlöschgruppenführer Schwarzenberg"}
    told = {"kind": "status", "t": T0, "node": "caller", "air_bar": 40}
    heard(post, incident, base(T0), caller, told, alarm(T0, "caller", text="I lie under a shelf. " * 8))
    heard(post, incident, responder(T0 + 200, "ff2", "A", [4, 2, 0]))
    commander.sits_at(width, height)
    commander.opens(server.url, incident)
    eventually(lambda: commander.banners)
    assert commander.words_are_under_the_caller
    close(post, incident)
    eventually(lambda: commander.mode == "CLOSED", within_s=15)
    assert commander.words_are_under_the_caller
    assert (commander.cut_off(), commander.off_the_screen) == ([], [])
