"""All of the watching can be done from the keyboard."""

from tests.end_to_end.commander import Commander
from tests.end_to_end.scene import base, heard, responder, two_on_two_storeys
from tests.running import Post, Server, eventually

T0 = 1_763_712_345.0


def test_the_keys_pause_step_select_and_choose_storeys(
    server: Server, post: Post, commander: Commander
) -> None:
    incident = two_on_two_storeys(post, T0)
    commander.opens(server.url, incident)
    newest = commander.clock
    assert commander.mode == "RECORDED"

    commander.presses("Space")
    eventually(lambda: commander.mode == "REPLAY")
    eventually(lambda: commander.clock == newest)
    for _ in range(6):
        commander.presses("ArrowLeft")
    eventually(lambda: seconds(newest) - seconds(commander.clock) == 6)
    commander.presses("ArrowRight")
    eventually(lambda: seconds(newest) - seconds(commander.clock) == 5)
    commander.presses("Space")
    eventually(lambda: commander.clock == newest)
    commander.presses("b")
    eventually(lambda: commander.mode == "RECORDED")

    commander.presses("n")
    eventually(lambda: commander.selected == "ff1")
    commander.presses("n")
    eventually(lambda: commander.selected == "ff2")
    assert "FF2" in commander.card
    commander.presses("p")
    eventually(lambda: commander.selected == "ff1")
    commander.presses("Escape")
    eventually(lambda: commander.selected is None and commander.card == "")

    commander.chooses_storey("Ground")
    commander.presses("PageUp")
    eventually(lambda: commander.storey == "First")
    commander.presses("a")
    eventually(lambda: commander.storey not in {"First", "Ground"})

    commander.presses("t")
    eventually(lambda: commander.theme == "dusk")
    commander.sits_at(1024, 600)
    commander.presses("?")
    commander.page.get_by_role("dialog").wait_for()
    assert commander.help_begins_at_its_head
    commander.presses("Escape")
    commander.page.get_by_role("dialog").wait_for(state="hidden")


def test_a_line_of_the_board_selects_its_responder(server: Server, post: Post, commander: Commander) -> None:
    incident = post.open_incident()
    heard(
        post, incident, base(T0), responder(T0, "ff1", "A", [2, 2, 0]), responder(T0, "ff2", "A", [4, 2, 0])
    )
    commander.opens(server.url, incident)
    commander.selects("ff2")
    eventually(lambda: commander.selected == "ff2")
    assert "FF2" in commander.card
    eventually(lambda: "node=ff2" in commander.page.url)


def seconds(clock: str) -> int:
    """Seconds of the day of "14:05:45"."""
    hours, minutes, rest = (int(part) for part in clock.split(":"))
    return hours * 3600 + minutes * 60 + rest
