import time

import msgspec
import pytest

from backend.bench.declared import Batch
from backend.bench.telemetry import BODIES, NAME_LENGTH, batch_bodies, name_place
from backend.log.decode import judge


@pytest.mark.parametrize("size", [10, 100])
def test_every_body_is_a_batch_without_a_bad_reading(size: int) -> None:
    now = time.time()
    bodies = batch_bodies(size, now)
    assert len(set(bodies)) == BODIES
    for body in bodies:
        judged = judge(body, size, now)
        assert len(judged.accepted) == size
        assert judged.rejected == ()


def test_the_plain_application_understands_the_same_bodies() -> None:
    for body in batch_bodies(10, time.time()):
        assert len(Batch.model_validate_json(body).readings) == 10


def test_a_batch_is_renamed_in_place() -> None:
    body = bytearray(batch_bodies(10, 0.0)[3])
    body[name_place(bytes(body))] = b"7" * NAME_LENGTH
    assert msgspec.json.decode(body)["batch"] == "7" * NAME_LENGTH
