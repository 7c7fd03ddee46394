"""What a viewer may send: nothing that it sends takes a replay out of its time."""

import json
import random

import pytest

from backend.replay.clock import ReplayClock
from backend.replay.control import FASTEST, SLOWEST, apply, understand


@pytest.mark.parametrize(
    "message",
    [
        b"",
        b"\xff\xfe",
        "[" * 100_000,
        "{}",
        "[]",
        "null",
        '{"seek": NaN}',
        '{"seek": Infinity}',
        '{"seek": 1e400}',
        '{"seek": -1}',
        '{"seek": 1e300}',
        '{"seek": ' + "9" * 5_000 + "}",
        '{"seek": "1000"}',
        '{"seek": true}',
        '{"speed": 0}',
        '{"speed": -1}',
        '{"speed": 1e9}',
        '{"speed": NaN}',
        '{"pause": 1}',
        '{"pause": "yes"}',
        '{"seek": 1000, "more": 1}',
        '{"seek": null}',
    ],
)
def test_what_is_no_control_is_refused_with_what_to_send(message: str | bytes) -> None:
    with pytest.raises(ValueError, match=r'send \{"seek": T\}'):
        understand(message)


def test_whatever_is_sought_in_a_flood_the_replay_stays_in_its_time() -> None:
    chance, wall_s = random.Random(7), 0.0
    clock = ReplayClock(1000.0, 1100.0, 1.0, wall_s)
    for _ in range(5_000):
        wall_s += chance.choice((0.0, 1e-6, 0.1, 1e6))
        told: dict[str, float | bool] = {
            "seek": chance.choice((0.0, 999.0, 1050.0, 1100.0, 4e9)),
            "speed": chance.uniform(SLOWEST, FASTEST),
            "pause": chance.random() < 0.5,
        }
        apply(understand(json.dumps(dict(chance.sample(sorted(told.items()), 2)))), clock, wall_s)
        assert 1000.0 <= clock.now(wall_s) <= clock.now(wall_s + 1e9) <= 1100.0
