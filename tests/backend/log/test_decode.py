import json
import math
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.errors import NotUnderstood, TooLarge
from backend.log.base import LoggedBatch
from backend.log.batch import accepted_readings
from backend.log.decode import MAX_MESSAGE, Judged, _judge_each, judge
from estimator.measurements import Alarm

GOOD: list[dict[str, Any]] = [
    {"kind": "range", "t": 100.0, "a": "ff1", "b": "b3", "range_m": 7.31},
    {"kind": "rssi", "t": 100.0, "a": "b3", "b": "ff1", "dbm": -60},
    {"kind": "displacement", "t": 100.0, "node": "ff1", "delta_m": [0.5, 0, 0.01]},
    {"kind": "node", "t": 100.0, "node": "ff1", "role": "responder", "callsign": "É7-2"},
    {"kind": "position", "t": 100.0, "node": "u", "wgs84": [59.1, 18.2, 30.0]},
    {
        "kind": "imu",
        "t": 100,
        "node": "f",
        "rate_hz": 100,
        "accel_mps2": [[0, 0, 9.8]],
        "gyro_radps": [[0, 0, 0]],
    },
]
RANGE = GOOD[0]


def judged(readings: object, now: float | None = None, sent: float | None = None) -> Judged:
    batch: dict[str, object] = {"gateway": "g", "batch": "b", "readings": readings}
    if sent is not None:
        batch["sent"] = sent
    return judge(json.dumps(batch).encode(), 10_000, now)


def test_good_readings_are_all_accepted() -> None:
    result = judged(GOOD)
    assert len(result.accepted) == len(GOOD)
    assert result.rejected == ()
    assert (result.gateway, result.batch, result.sent) == ("g", "b", None)


def test_a_batch_may_be_empty() -> None:
    assert judged([]).accepted == []


@pytest.mark.parametrize(
    ("bad", "code", "field"),
    [
        ({**RANGE, "kind": "sonar"}, "unknown_kind", "kind"),
        ({"t": 1}, "missing_field", "kind"),
        ({k: v for k, v in RANGE.items() if k != "range_m"}, "missing_field", "range_m"),
        ({k: v for k, v in RANGE.items() if k != "t"}, "missing_field", "t"),
        ({**RANGE, "colour": "red"}, "unknown_field", "colour"),
        ({**RANGE, "range_m": "7"}, "wrong_type", "range_m"),
        ({**RANGE, "range_m": None}, "wrong_type", "range_m"),
        ({**RANGE, "t": True}, "wrong_type", "t"),
        ({**RANGE, "kind": 3}, "wrong_type", "kind"),
        ({**RANGE, "range_m": -0.1}, "out_of_bounds", "range_m"),
        ({**RANGE, "range_m": 1e6}, "out_of_bounds", "range_m"),
        ({**RANGE, "sigma_m": 0}, "out_of_bounds", "sigma_m"),
        ({**RANGE, "t": -1}, "out_of_bounds", "t"),
        ({**RANGE, "t": 1e300}, "out_of_bounds", "t"),
        ({**RANGE, "range_m": 10**400}, "out_of_bounds", "range_m"),
        ({**RANGE, "a": "x" * 65}, "out_of_bounds", "a"),
        ({**RANGE, "a": ""}, "out_of_bounds", "a"),
        ({**RANGE, "a": "ff 1"}, "not_an_identifier", "a"),
        ({**RANGE, "a": "ff1\n"}, "not_an_identifier", "a"),
        ({**RANGE, "b": "ff1"}, "self_reading", None),
        ({"kind": "drop", "t": 1, "node": "x", "by": "x"}, "self_reading", None),
        ({**GOOD[2], "delta_m": [1, 2]}, "wrong_length", "delta_m"),
        ({**GOOD[2], "delta_m": [1, 2, "3"]}, "wrong_type", "delta_m[2]"),
        ({**GOOD[2], "from_t": 101}, "contradiction", None),
        ({**GOOD[3], "role": "chief"}, "unknown_value", "role"),
        ({**GOOD[4], "wgs84": [999, 0, 0]}, "out_of_bounds", "wgs84[0]"),
        ({**GOOD[4], "position_m": [0, 0, 0]}, "contradiction", None),
        ({**GOOD[5], "gyro_radps": []}, "wrong_length", "gyro_radps"),
        (7, "wrong_type", None),
        (None, "wrong_type", None),
        ([], "wrong_type", None),
    ],
)
def test_a_bad_reading_is_named_by_index_code_and_field(bad: object, code: str, field: str | None) -> None:
    result = judged([RANGE, bad, RANGE])
    assert len(result.accepted) == 2
    (fault,) = result.rejected
    assert (fault.index, fault.code, fault.field) == (1, code, field)
    assert fault.message


def test_a_number_beyond_every_float_is_out_of_bounds() -> None:
    body = b'{"gateway":"g","batch":"b","readings":[{"kind":"range","t":1,"a":"a","b":"b","range_m":1e999}]}'
    (fault,) = judge(body, 10, None).rejected
    assert (fault.code, fault.field) == ("out_of_bounds", "range_m")


def test_a_message_never_grows_with_what_came() -> None:
    (fault,) = judged([{**RANGE, "kind": "x" * 100_000}]).rejected
    assert len(fault.message) <= MAX_MESSAGE
    (fault,) = judged([{**RANGE, "y" * 100_000: 1}]).rejected
    assert len(fault.message) <= MAX_MESSAGE
    assert len(fault.field or "") <= MAX_MESSAGE


def test_a_reading_from_the_future_is_set_aside() -> None:
    late = {**RANGE, "t": 170.5}
    assert judged([RANGE, late], sent=110.4).rejected[0].code == "time_in_future"
    assert judged([RANGE, late], sent=110.5).rejected == ()
    assert judged([RANGE, late], now=110.4).rejected[0].index == 1
    assert judged([RANGE, late], now=110.4, sent=1_000.0).rejected[0].index == 1
    assert judged([RANGE, late]).rejected == ()
    call = {"kind": "alarm", "t": 9_000.0, "node": "ff1", "alarm": "mayday", "state": "raised"}
    assert [fault.index for fault in judged([call, late], now=110.4).rejected] == [1], "a call is never lost"


def test_samples_that_end_in_the_future_are_set_aside() -> None:
    """Else one unit with a wrong rate would make everybody else's readings too late."""
    imu = {
        "kind": "imu",
        "t": 100.0,
        "node": "ff1",
        "rate_hz": 25.0,
        "accel_mps2": [[0.0, 0.0, 9.8]] * 5000,
        "gyro_radps": [[0.0, 0.0, 0.0]] * 5000,
    }
    told = judged([RANGE, imu], sent=110.4).rejected
    assert [(fault.index, fault.code) for fault in told] == [(1, "time_in_future")]
    assert "the last sample" in told[0].message


def test_readings_from_the_far_past_are_accepted() -> None:
    assert judged([{**RANGE, "t": 0}], now=1_763_712_345.0, sent=1_763_712_345.0).rejected == ()


def test_too_many_readings_are_too_large_good_or_bad() -> None:
    for reading in (RANGE, {}):
        body = json.dumps({"gateway": "g", "batch": "b", "readings": [reading] * 11}).encode()
        with pytest.raises(TooLarge, match="11 readings"):
            judge(body, 10, None)


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"null",
        b"[]",
        b"{",
        b"{}",
        b'{"gateway":"g","batch":"b"}',
        b'{"gateway":"g","batch":"b","readings":{}}',
        b'{"gateway":"g","batch":"b","readings":null}',
        b'{"gateway":"g","batch":"","readings":[]}',
        b'{"gateway":"g g","batch":"b","readings":[]}',
        b'{"gateway":7,"batch":"b","readings":[]}',
        b'{"gateway":"g","batch":"b","sent":"now","readings":[]}',
        b'{"gateway":"g","batch":"b","sent":-1,"readings":[]}',
        b'{"gateway":"g","batch":"b","readings":[],"note":"x"}',
        b'{"gateway":"g","batch":"b","readings":[]} x',
        b'{"gateway":"g","batch":"b","readings":[{"kind":"range","t":NaN}]}',
        b'{"gateway":"g","batch":"b","readings":[{"kind":"range","t":-Infinity}]}',
        b'{"gateway":"g","batch":"b","readings":[{"kind":"?","t":01}]}',
        b'{"gateway":"g","batch":"b","readings":[{"kind":"\xff"}]}',
        b'{"gateway":"g","batch":"b","readings":[{"x":"\xff"},{"kind":"?"}]}',
        b'\xef\xbb\xbf{"gateway":"g","batch":"b","readings":[]}',
        b'{"gateway":"g","batch":"b","readings":' + b"[" * 100_000,
        b'{"gateway":"g","batch":"b","readings":[' + b'{"a":' * 100_000,
        b'{"gateway":"g","batch":"b","readings":[' + b"[" * 5_000 + b"]" * 5_000 + b"]}",
        '{"gateway":"g","batch":"b","readings":[]}'.encode("utf-16"),
    ],
)
def test_what_is_no_batch_is_not_understood(body: bytes) -> None:
    with pytest.raises(NotUnderstood) as refused:
        judge(body, 10_000, None)
    assert refused.value.detail


def test_of_a_field_named_twice_the_last_counts_here_and_in_the_log() -> None:
    reading = b'{"kind":"altitude","t":1,"t":2,"node":"n","up_m":3}'
    body = b'{"gateway":"x","gateway":"g","batch":"b","readings":[1],"readings":[%s]}' % reading
    result = judge(body, 10, None)
    assert result.gateway == "g"
    assert result.accepted == accepted_readings(row(body, result))
    assert [reading.t for reading in result.accepted] == [2.0]


def row(body: bytes, result: Judged) -> LoggedBatch:
    return LoggedBatch(
        seq=1, gateway="g", batch="b", received=0.0, sent=None, body=body, rejected=result.rejected
    )


numbers = (
    st.floats(allow_nan=False, allow_infinity=False)
    | st.integers(-(10**30), 10**30)
    | st.sampled_from([0, -1, 1e308])
)
scalars = (
    st.none() | st.booleans() | numbers | st.text(max_size=5) | st.sampled_from(["ff1", "b3", "range", "uwb"])
)
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=2),
    max_leaves=4,
)
changed = st.sampled_from(GOOD).flatmap(
    lambda good: st.dictionaries(st.sampled_from([*good, "sigma_m", "t", "extra"]), values, max_size=2).map(
        lambda change: {**good, **change}
    )
)
readings_of_any_kind = st.lists(st.sampled_from(GOOD) | changed | values, max_size=5)


@given(readings=readings_of_any_kind, sent=st.none() | st.floats(0, 1e9), now=st.none() | st.floats(0, 1e9))
def test_the_fast_way_and_the_careful_way_judge_alike(
    readings: list[object], sent: float | None, now: float | None
) -> None:
    body = json.dumps({"gateway": "g", "batch": "b", "sent": sent, "readings": readings}).encode()
    fast, careful = judge(body, 10_000, now), _judge_each(body, 10_000, now)
    assert fast == careful
    assert len(fast.accepted) + len(fast.rejected) == len(readings)
    assert all(math.isfinite(reading.t) for reading in fast.accepted)
    assert accepted_readings(row(body, fast)) == list(fast.accepted)
    msgspec.json.encode(fast.rejected)


@given(body=st.binary(max_size=200))
def test_arbitrary_bytes_are_a_batch_or_not_understood(body: bytes) -> None:
    try:
        judge(body, 10, 0.0)
    except NotUnderstood as refused:
        refused.body()


@given(data=st.data())
def test_a_damaged_batch_is_a_batch_or_not_understood(data: st.DataObject) -> None:
    body = bytearray(json.dumps({"gateway": "g", "batch": "b", "sent": 1.0, "readings": GOOD[:3]}).encode())
    for _ in range(data.draw(st.integers(1, 4))):
        body[data.draw(st.integers(0, len(body) - 1))] = data.draw(st.integers(0, 255))
    try:
        result = judge(bytes(body), 10, None)
    except (NotUnderstood, TooLarge) as refused:
        refused.body()
    else:
        body.decode()
        assert len(accepted_readings(row(bytes(body), result))) == len(result.accepted)


HALVES = [
    r"x\ud83d",
    r"\udc00",
    r"\ud83d\ud83d",
    r"\ud83d\u0041",
    r"\\\uD83Dx",
    r"\ude00\ud83d",
    "x" * 90 + r"\ud83d",
]


def alarm(text: str) -> str:
    return f'{{"kind":"alarm","t":1,"node":"ff1","alarm":"mayday","state":"raised","text":"{text}"}}'


@pytest.mark.parametrize("half", HALVES)
def test_a_text_that_was_cut_within_a_character_sets_its_reading_aside_only(half: str) -> None:
    cut = [alarm(half), f'{{"{half}":1}}', f'"{half}"']
    sound = [alarm("trapped"), alarm(r"\ud83d\ude00"), alarm(r"\\ud83d"), alarm(r"\ufffd")]
    body = f'{{"gateway":"g","batch":"b","readings":[{",".join([*cut, *sound])}]}}'
    result = judge(body.encode(), 10, None)
    assert [(fault.index, fault.code) for fault in result.rejected] == [
        (index, "half_a_character") for index in range(len(cut))
    ]
    texts = [reading.text for reading in result.accepted if isinstance(reading, Alarm)]
    assert texts == ["trapped", "\U0001f600", r"\ud83d", "\ufffd"]
    assert accepted_readings(row(body.encode(), result)) == list(result.accepted)


def test_what_is_cut_short_or_has_half_a_character_around_its_readings_is_refused() -> None:
    for body, told in (
        (r'{"gateway":"g","batch":"b","readings":["\ud83d', "truncated"),
        (r'{"gateway":"g\ud83d","batch":"b","readings":[]}', "`gateway`"),
        (r'{"gateway":"g","batch":"b","readings":[],"\ud83d":1}', "unknown field"),
    ):
        with pytest.raises(NotUnderstood, match=told):
            judge(body.encode(), 10, None)


def test_readings_that_a_later_version_refuses_are_left_out_of_an_old_log() -> None:
    altitude = b'{"kind":"altitude","t":1,"node":"n","up_m":3}'
    body = b'{"gateway":"g","batch":"b","readings":[%s,{"kind":"gone"}]}' % altitude
    old = LoggedBatch(seq=1, gateway="g", batch="b", received=0.0, sent=None, body=body, rejected=())
    assert [reading.t for reading in accepted_readings(old)] == [1.0]
