import asyncio
import gzip
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.errors import NotUnderstood, TooLarge, WrongMediaType
from backend.ingest.body import MAX_MEMBERS, ClientGone, read_body
from tests.backend.ingest.asgi import Body, scope

LIMIT = 1_000
JSON = {"content-type": "application/json"}
GZIP = {**JSON, "content-encoding": "gzip"}


def read(body: Body, headers: dict[str, str]) -> bytes:
    return asyncio.run(read_body(scope("/", headers), body, LIMIT))


def cut(data: bytes, size: int) -> list[bytes]:
    return [data[start : start + size] for start in range(0, len(data), size)] or [b""]


@given(data=st.binary(max_size=LIMIT), size=st.integers(1, LIMIT), compressed=st.booleans())
def test_a_body_is_read_whole_however_it_is_cut(data: bytes, size: int, compressed: bool) -> None:
    if compressed:
        parts = cut(gzip.compress(data, 1), size)
        if sum(map(len, parts)) <= LIMIT:
            assert read(Body(parts), GZIP) == data
    else:
        assert read(Body(cut(data, size)), JSON) == data


@given(data=st.lists(st.binary(max_size=200), min_size=2, max_size=5), size=st.integers(1, LIMIT))
def test_gzip_of_several_members_is_one_body(data: list[bytes], size: int) -> None:
    sent = b"".join(gzip.compress(one, 1) for one in data)
    if len(sent) <= LIMIT and sum(map(len, data)) <= LIMIT:
        assert read(Body(cut(sent, size)), GZIP) == b"".join(data)


@pytest.mark.parametrize("size", [7, 10 * LIMIT])
def test_members_are_too_large_together_though_each_is_within_the_limit(size: int) -> None:
    with pytest.raises(TooLarge):
        read(Body(cut(gzip.compress(bytes(LIMIT)) + gzip.compress(b"x"), size)), GZIP)


def test_members_without_end_are_refused_soon() -> None:
    body = Body(cut(gzip.compress(b"") * (MAX_MEMBERS + 20), 64 * 1024))
    with pytest.raises(NotUnderstood, match="members"):
        asyncio.run(read_body(scope("/", GZIP), body, 1_000_000))


@pytest.mark.parametrize("parts", [1, 7])
@pytest.mark.parametrize("headers", [JSON, GZIP])
def test_a_body_over_the_limit_is_too_large(parts: int, headers: dict[str, str]) -> None:
    data = bytes(LIMIT + 1)
    sent = gzip.compress(data) if headers is GZIP else data
    with pytest.raises(TooLarge):
        read(Body(cut(sent, len(sent) // parts + 1)), headers)


def test_a_body_announced_as_too_large_is_not_read() -> None:
    body = Body([b"x"])
    with pytest.raises(TooLarge):
        read(body, {**JSON, "content-length": str(LIMIT + 1)})
    assert body.given == 0


def test_a_bomb_is_given_up_long_before_it_is_decompressed() -> None:
    bomb = gzip.compress(bytes(100_000_000))
    body = Body(cut(bomb, 100))
    with pytest.raises(TooLarge):
        asyncio.run(read_body(scope("/", GZIP), body, 10 * LIMIT))
    assert body.given < 10


WHOLE = gzip.compress(b"{}")
DAMAGED = {
    "a byte short": WHOLE[:-1],
    "without its check sum": WHOLE[:-8],
    "cut in its header": WHOLE[:5],
    "empty": b"",
    "followed by another byte": WHOLE + b"x",
    "followed by half of another member": WHOLE + WHOLE[:9],
    "not compressed": b"{}",
    "zlib": zlib.compress(b"{}"),
    "with another check sum": WHOLE[:-5] + b"12345",
}


@pytest.mark.parametrize("damaged", DAMAGED.values(), ids=DAMAGED)
@pytest.mark.parametrize("size", [1, 1_000])
def test_damaged_gzip_is_not_understood(damaged: bytes, size: int) -> None:
    with pytest.raises(NotUnderstood):
        read(Body(cut(damaged, size)), GZIP)


@pytest.mark.parametrize(
    "kind",
    ["application/json; charset=utf-8", "Application/JSON", "application/json ;x=y", "application/json"],
)
def test_json_is_taken_with_parameters(kind: str) -> None:
    assert read(Body([b"{}"]), {"content-type": kind}) == b"{}"


@pytest.mark.parametrize(
    "kind", ["", "text/plain", "application/jsonp", "application/x-www-form-urlencoded", "\xff"]
)
def test_other_content_types_are_refused(kind: str) -> None:
    with pytest.raises(WrongMediaType):
        read(Body([b"{}"]), {"content-type": kind} if kind else {})


@pytest.mark.parametrize("encoding", ["br", "deflate", "gzip, gzip", "zstd"])
def test_other_encodings_are_refused(encoding: str) -> None:
    with pytest.raises(WrongMediaType):
        read(Body([b"{}"]), {**JSON, "content-encoding": encoding})


@pytest.mark.parametrize("encoding", ["identity", "GZIP", "x-gzip", " gzip "])
def test_known_encodings_are_taken_in_any_spelling(encoding: str) -> None:
    sent = b"{}" if encoding == "identity" else gzip.compress(b"{}")
    assert read(Body([sent]), {**JSON, "content-encoding": encoding}) == b"{}"


@pytest.mark.parametrize("parts", [[None], [b"{", None]])
def test_a_client_that_hangs_up_leaves_no_body(parts: list[bytes | None]) -> None:
    with pytest.raises(ClientGone):
        read(Body(parts), JSON)
