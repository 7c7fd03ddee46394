"""Who hears whom, second by second: crossings of a reach, and packets lost inside it."""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.memory.hearing import Crossing, Heard, Listener, listen


def heard(seconds: Sequence[str], silent: int = 1, each_s: float = 1.0) -> tuple[list[Crossing], int, int]:
    """What ff hears in each second, a letter a radio; a space: nothing at all."""
    listener, crossings, packets, lost = Listener(), [], 0, 0
    for second, names in enumerate(seconds):
        if names != " ":
            now = Heard(dict.fromkeys(names, second * each_s), len(names))
            told = listen("ff", listener, now, silent)
            listener, packets, lost = told.listener, packets + told.heard, lost + told.lost
            crossings += told.crossings
    return crossings, packets, lost


def test_a_radio_that_falls_silent_among_others_is_left_behind_between_two_seconds() -> None:
    crossings, _, lost = heard(["ab", "ab", "ab", "a", "a"])
    assert crossings == [Crossing(t=2.5, a="ff", b="b")]
    assert lost == 0


def test_a_radio_that_is_heard_again_is_come_back_to() -> None:
    crossings, _, _ = heard(["ab", "ab", "ab", "a", "a", "a", "ab", "ab"])
    assert crossings == [Crossing(t=2.5, a="ff", b="b"), Crossing(t=5.5, a="ff", b="b")]


def test_that_a_radio_is_heard_again_is_known_at_once() -> None:
    assert heard(["ab", "ab", "ab", "a", "a", "a", "ab"])[0][-1] == Crossing(t=5.5, a="ff", b="b")


def test_nothing_is_made_of_the_silence_of_a_second_before_the_next_one_has_begun() -> None:
    """A gateway may post the rest of it later."""
    assert heard(["ab", "ab", "ab", "a"])[0] == []


def test_where_packets_are_lost_one_second_of_silence_is_a_lost_packet() -> None:
    crossings, packets, lost = heard(["ab", "ab", "ab", "a", "ab", "ab"], silent=2)
    assert crossings == []
    # Of five seconds that are over nine packets came; the first of each radio tells nothing of its losses.
    assert (packets, lost) == (7, 1)


def test_a_radio_that_is_heard_again_at_once_was_never_out_of_reach() -> None:
    assert heard(["ab", "ab", "ab", "a", "ab", "ab"]) == ([], 7, 1)
    assert heard(["ab", "ab", "ab", "a", "a", "ab", "ab"], silent=2) == ([], 8, 2)


def test_two_seconds_of_silence_are_a_reach_left_when_the_first_began_and_nothing_is_lost() -> None:
    crossings, _, lost = heard(["ab", "ab", "ab", "a", "a", "a"], silent=2)
    assert crossings == [Crossing(t=2.5, a="ff", b="b")]
    assert lost == 0


def test_a_listener_that_hears_nobody_at_all_has_left_no_reach() -> None:
    """Its gateway or itself was silent."""
    assert heard(["ab", "ab", "ab", " ", " ", " ", "ab", "ab"])[0] == []


def test_who_is_not_listened_to_for_long_has_crossed_nobody_knows_when() -> None:
    assert heard(["ab", "ab", "ab", " ", " ", "a", "a", "a", " ", " ", "ab", "ab"])[0] == []
    assert heard(["ab", "ab", "ab", "a", "a", "ab", "ab"], each_s=2.0)[0] == []


def test_a_radio_that_was_never_heard_or_hardly_ever_falls_silent_for_nobody() -> None:
    assert heard(["a", "a", "a", "ab", "a", "a"])[0] == []
    assert heard(["ab", "ab", "a", "a", "a"])[0] == []


@pytest.mark.parametrize("silent", [1, 2])
def test_a_radio_whose_place_another_one_takes_has_left_no_reach(silent: int) -> None:
    """A unit that tells the strongest three hears the third one still when a fourth has become louder."""
    assert heard([*["abc"] * 4, *["abd"] * 4, *["abc"] * 4], silent)[0] == []


def test_beside_one_that_takes_another_ones_place_a_reach_is_left_where_fewer_are_heard() -> None:
    assert heard(["abc", "abc", "abc", "ad", "ad"])[0] == [
        Crossing(t=2.5, a="ff", b="b"),
        Crossing(t=2.5, a="ff", b="c"),
    ]


def test_as_many_are_told_at_once_as_one_scan_tells_or_the_whole_second_where_each_comes_by_itself() -> None:
    radios = {"a": 0.2, "b": 0.4, "c": 0.8}
    assert Heard(radios, at_once=2).told == 2
    assert Heard(radios, at_once=1).told == 3


@given(
    seconds=st.lists(st.sets(st.sampled_from("abc")), min_size=2, max_size=40), silent=st.sampled_from([1, 2])
)
def test_each_radio_is_left_and_come_back_to_in_turns_and_halfway_between_seconds(
    seconds: list[set[str]], silent: int
) -> None:
    crossings, packets, lost = heard(["z" + "".join(sorted(names)) for names in seconds], silent)
    assert packets >= 0
    assert lost >= 0
    for radio in "abc":
        mine = [crossing.t for crossing in crossings if crossing.b == radio]
        assert mine == sorted(mine)
        for t in mine:
            before, after = int(t - 0.5), int(t + 0.5)
            assert t == pytest.approx(before + 0.5)
            assert (radio in seconds[before]) != (radio in seconds[after])
