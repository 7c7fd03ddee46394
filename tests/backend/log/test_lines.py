import json

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.errors import FieldError, NotUnderstood
from backend.log.base import LoggedBatch
from backend.log.lines import log_line, parse_line

json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=10,
)


def logged(readings: bytes, rejected: tuple[FieldError, ...] = (), sent: float | None = None) -> LoggedBatch:
    body = b'{"readings" : %s, "gateway":"g",\n"batch":"b"}' % readings
    return LoggedBatch(seq=7, gateway="g", batch="b", received=2.5, sent=sent, body=body, rejected=rejected)


@given(readings=st.lists(json_values, max_size=4), indent=st.sampled_from([None, 0, 3]), ascii_=st.booleans())
def test_a_line_carries_the_readings_as_they_came(
    readings: list[object], indent: int | None, ascii_: bool
) -> None:
    came = json.dumps(readings, indent=indent, ensure_ascii=ascii_, separators=(" , ", ":  "))
    line = log_line(logged(came.encode(errors="surrogatepass") if ascii_ else came.encode()))
    assert line.endswith(b"\n")
    assert line.count(b"\n") == 1
    assert b"\r" not in line
    parsed = parse_line(line)
    assert bytes(parsed.readings).decode() == came.replace("\n", " ")
    assert json.loads(bytes(parsed.readings)) == readings


def test_a_line_names_what_was_set_aside_and_when_it_was_sent() -> None:
    fault = FieldError(code="unknown_kind", message="m", index=0, field="kind")
    line = log_line(logged(b'[{"kind":"?"}]', (fault,), sent=2.0))
    assert json.loads(line) == {
        "seq": 7,
        "received": 2.5,
        "gateway": "g",
        "batch": "b",
        "sent": 2.0,
        "rejected": [{"code": "unknown_kind", "message": "m", "index": 0, "field": "kind"}],
        "readings": [{"kind": "?"}],
    }
    assert parse_line(line).rejected == (fault,)


def test_a_line_posts_again_as_the_same_batch() -> None:
    parsed = parse_line(log_line(logged(b'[ {"kind":"x" , "t":1} ]', sent=1.0)))
    assert parsed.body() == b'{"gateway":"g","batch":"b","sent":1.0,"readings":[ {"kind":"x" , "t":1} ]}'
    assert "sent" not in json.loads(parse_line(log_line(logged(b"[]"))).body())


def test_only_gateway_batch_and_readings_are_needed() -> None:
    parsed = parse_line(b'{"gateway":"g","batch":"b","readings":[],"note":"from a later version"}')
    assert (parsed.seq, parsed.received, parsed.sent) == (None, None, None)
    assert parsed.readings == msgspec.Raw(b"[]")


@pytest.mark.parametrize("line", [b"", b"[]", b"{", b'{"gateway":"g"}', b"\xff", b"[" * 100_000, b"nul"])
def test_what_is_no_line_is_refused(line: bytes) -> None:
    with pytest.raises(NotUnderstood):
        parse_line(line)
