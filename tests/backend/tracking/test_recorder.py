"""Incident time, and where it is cut."""

from hypothesis import given
from hypothesis import strategies as st

from backend.tracking.recorder import LONGEST_PIECE, pieces, row_of
from estimator.measurements import Altitude

epochs = st.lists(st.floats(0.0, 60.0).map(lambda t: round(t, 2)), max_size=60)


def at(t: float) -> Altitude:
    return Altitude(t=t, node="ff1", up_m=0.0)


def cut(batches: list[list[float]]) -> list[tuple[int, list[float]]]:
    """Each row with the epochs of everything that was folded before it."""
    newest_t: float | None = None
    folded: list[float] = []
    rows = []
    for batch in batches:
        for piece in pieces([at(t) for t in batch], newest_t):
            if piece.row is not None:
                rows.append((piece.row, list(folded)))
            folded += [reading.t for reading in piece.readings]
            newest_t = piece.newest_t
    return rows


def test_a_row_is_made_when_incident_time_passes_its_second() -> None:
    assert cut([[0.5, 1.0, 1.5, 2.0, 2.5]]) == [(1, [0.5, 1.0]), (2, [0.5, 1.0, 1.5, 2.0])]


def test_the_second_in_which_incident_time_is_has_no_row_yet() -> None:
    assert cut([[0.5]]) == []
    assert cut([[1.0]]) == []
    assert (row_of(0.5), row_of(1.0), row_of(None)) == (1, 1, None)


def test_after_silence_only_the_first_second_gets_a_row() -> None:
    assert cut([[0.5], [100.5]]) == [(1, [0.5])]


def test_a_late_reading_goes_into_the_next_row() -> None:
    assert cut([[1.5], [0.2], [2.5]]) == [(2, [1.5, 0.2])]


@given(epochs, st.integers(0, 2**32))
def test_rows_of_readings_in_order_do_not_depend_on_batches(times: list[float], cuts: int) -> None:
    times = sorted(times)
    batches: list[list[float]] = [[]]
    for i, t in enumerate(times):
        if cuts >> (i % 32) & 1:
            batches.append([])
        batches[-1].append(t)
    assert cut(batches) == cut([times]) == cut([[t] for t in times])


@given(st.lists(epochs, max_size=5))
def test_a_row_holds_nothing_of_later_seconds_and_each_second_has_one_at_most(
    batches: list[list[float]],
) -> None:
    rows = cut(batches)
    assert all(t <= second for second, folded in rows for t in folded)
    seconds = [second for second, _ in rows]
    assert seconds == sorted(set(seconds))


@given(st.lists(epochs, max_size=5))
def test_every_reading_is_folded_once(batches: list[list[float]]) -> None:
    newest_t: float | None = None
    for batch in batches:
        made = list(pieces([at(t) for t in batch], newest_t))
        assert [reading.t for piece in made for reading in piece.readings] == sorted(batch)
        newest_t = made[-1].newest_t if made else newest_t


def test_a_second_with_thousands_of_readings_is_folded_in_turns() -> None:
    made = list(pieces([at(0.5)] * (2 * LONGEST_PIECE + 1), None))
    assert [len(piece.readings) for piece in made] == [LONGEST_PIECE, LONGEST_PIECE, 1]
