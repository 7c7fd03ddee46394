from hypothesis import given
from hypothesis import strategies as st

from backend.errors import Conflict, FieldError, NotFound, Problem
from backend.log.base import Appended, LogUnwritable, NewBatch
from backend.log.writer_wire import (
    LENGTHS,
    Frames,
    batch_frame,
    parse_batch,
    parse_written,
    problem_of,
    written_frame,
)

faults = st.builds(
    FieldError, code=st.text(), message=st.text(), index=st.integers(0, 9_999), field=st.text() | st.none()
)
batches = st.builds(
    NewBatch,
    incident=st.text(),
    gateway=st.text(),
    batch=st.text(),
    received=st.floats(allow_nan=False),
    sent=st.floats(allow_nan=False) | st.none(),
    body=st.binary(max_size=300),
    accepted=st.integers(0, 10_000),
    rejected=st.lists(faults, max_size=3).map(tuple),
)


@given(sent=st.lists(batches, max_size=6), cut=st.integers(1, 64))
def test_batches_arrive_as_they_were_sent_however_the_stream_is_cut(sent: list[NewBatch], cut: int) -> None:
    stream = b"".join(piece for batch in sent for piece in batch_frame(batch))
    frames = Frames()
    came = [
        parse_batch(head, body)
        for start in range(0, len(stream), cut)
        for head, body in frames.feed(stream[start : start + cut])
    ]
    assert came == sent


def test_outcomes_come_back_in_their_order() -> None:
    done = Appended(3, 2, duplicate=True, rejected=(FieldError(code="c", message="m", index=1),))
    problems = [NotFound("a"), Conflict("b"), LogUnwritable("c", retry_after_s=5), Problem("d")]
    written = parse_written(written_frame(0.5, [done, *problems])[LENGTHS.size :])
    assert written.seconds == 0.5
    assert written.outcomes[0] == (done, None)
    back = [problem_of(refused) for _, refused in written.outcomes[1:] if refused is not None]
    assert [(type(one), one.detail, one.retry_after_s) for one in back] == [
        (type(one), one.detail, one.retry_after_s) for one in problems
    ]
