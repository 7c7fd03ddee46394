"""A link leads to what it names, and a page that is loaded again shows what it showed."""

from pathlib import Path

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import LEVELS, base, heard, recorded, responder, step
from tests.running import Post, Server, eventually, running

T0 = 1_763_712_345.0


def two_incidents(post: Post) -> str:
    """An incident, and after it a newer one; the older one's identifier."""
    older = post.open_incident("the older", levels=LEVELS)
    heard(post, older, base(T0), responder(T0, "ff1", "A", [2, 2, 3], sigma_m=0.2))
    for second in range(1, 7):
        heard(post, older, step(T0 + second, "ff1", [0.2, 0, 0]))
    recorded(post, older, T0 + 6)
    newer = post.open_incident("the newer")
    heard(post, newer, base(T0), responder(T0, "ff9", "B", [2, 2, 0]))
    return older


def test_a_link_opens_its_incident_storey_and_responder_though_there_is_a_newer_incident(
    server: Server, post: Post, commander: Commander
) -> None:
    older = two_incidents(post)
    commander.follows_link(server.url, older, node="ff1", level=1)
    assert commander.incident == "the older"
    eventually(lambda: commander.selected == "ff1")
    assert commander.storey == "First"
    assert "FF1" in commander.card

    commander.reloads()
    assert commander.incident == "the older"
    eventually(lambda: commander.selected == "ff1")
    assert commander.storey == "First"


def test_a_link_to_one_of_many_brings_the_line_and_the_card_into_view(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = post.open_incident()
    heard(post, incident, base(T0), *(responder(T0, f"ff{at}", "A", [at, 2, 0]) for at in range(10, 40)))
    commander.sits_at_a_tablet()
    commander.follows_link(server.url, incident, node="ff30")
    eventually(lambda: "FF30" in commander.card)
    eventually(lambda: commander.is_on_the_board("ff30"))


def test_a_link_to_a_moment_opens_the_replay_there(server: Server, post: Post, commander: Commander) -> None:
    older = two_incidents(post)
    commander.follows_link(server.url, older)
    newest = commander.clock
    commander.follows_link(server.url, older, t=T0 + 4)
    eventually(lambda: commander.mode == "REPLAY" and commander.clock not in {"–", newest})
    moment = commander.clock
    assert moment < newest
    commander.reloads()
    eventually(lambda: commander.mode == "REPLAY" and commander.clock == moment)


def test_a_link_to_an_incident_that_does_not_exist_says_so_and_shows_no_other_one(
    server: Server, post: Post, commander: Commander
) -> None:
    two_incidents(post)
    commander.page.goto(f"{server.url}/#incident=nowhere")
    eventually(lambda: "nowhere" in commander.trouble)
    assert "choose one" in commander.trouble
    assert "/api/" not in commander.trouble
    assert commander.incident == "Choose an incident"
    assert "No incident chosen" in commander.board_words
    commander.chooses_incident("the older")
    commander.sees("FF1", "Was live")
    eventually(lambda: commander.trouble == "")


def test_without_a_link_the_newest_incident_is_opened(
    server: Server, post: Post, commander: Commander
) -> None:
    two_incidents(post)
    commander.page.goto(server.url)
    eventually(lambda: commander.incident == "the newer")


def test_a_screen_that_was_opened_before_there_was_an_incident_finds_the_first(
    tmp_path: Path, commander: Commander
) -> None:
    with running(tmp_path / "data") as server:
        server.until_it_computes()
        commander.page.goto(server.url)
        eventually(lambda: commander.incident == "No incident yet")
        post = Post(server.url)
        first = post.open_incident("the first")
        heard(post, first, base(T0), responder(T0, "ff1", "A", [2, 2, 0]))
        eventually(lambda: commander.incident == "the first")
        commander.sees("FF1", "Was live")
        post.http.close()


def test_a_swipe_back_closes_the_card_and_leaves_neither_the_screen_nor_the_storey(
    server: Server, post: Post, commander: Commander
) -> None:
    older = two_incidents(post)
    commander.follows_link(server.url, older)
    commander.selects("ff1")
    eventually(lambda: "FF1" in commander.card)
    commander.chooses_storey("First")
    commander.swipes_back()
    eventually(lambda: commander.card == "")
    assert (commander.incident, commander.storey) == ("the older", "First")
    assert set(commander.board()) == {"FF1"}

    commander.chooses_incident("the newer")
    eventually(lambda: "FF9" in commander.board())
    commander.swipes_back()
    eventually(lambda: "FF1" in commander.board())
    assert (commander.incident, commander.storey) == ("the older", "First")
