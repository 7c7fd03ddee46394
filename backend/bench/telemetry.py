"""Telemetry as a building full of people sends it, made up in bulk for the benchmarks."""

import json
import random

BODIES = 64
"""Different bodies that are sent in turn: enough that no cache of ours or of the processor knows them."""

GATEWAYS = 8
NAME_LENGTH = 12


def readings_json(count: int, t: float, seed: int) -> bytes:
    """A JSON array of readings, in the mix that PDR units and radios make.

    Args:
        count: readings.
        t: epoch of the newest, Unix seconds.
        seed: of the values.
    """
    chance = random.Random(seed)  # noqa: S311 - values for a benchmark
    return json.dumps([_reading(i, t - 0.01 * (count - i), chance) for i in range(count)]).encode()


def _reading(i: int, t: float, chance: random.Random) -> dict[str, object]:
    unit, mate, crumb = f"ff{i % 20:02d}", f"ff{(i + 7) % 20:02d}", f"bc{chance.randrange(60):03d}"
    t = round(t, 3)
    match i % 10:
        case 0 | 3 | 6:
            delta = [
                round(chance.gauss(0.5, 0.3), 4),
                round(chance.gauss(0, 0.3), 4),
                round(chance.gauss(0, 0.02), 4),
            ]
            heading = round(chance.uniform(-3.14, 3.14), 4)
            return {"kind": "displacement", "t": t, "node": unit, "delta_m": delta, "heading_rad": heading}
        case 1 | 4 | 7:
            distance = round(chance.uniform(0.5, 40), 3)
            return {"kind": "range", "t": t, "a": unit, "b": crumb, "range_m": distance, "technology": "uwb"}
        case 2 | 5:
            return {"kind": "rssi", "t": t, "a": crumb, "b": unit, "dbm": -chance.randrange(40, 95)}
        case 8:
            return {
                "kind": "pressure",
                "t": t,
                "node": mate,
                "pressure_pa": round(chance.gauss(1.013e5, 30), 1),
            }
        case _:
            air, still = chance.randrange(50, 300), round(chance.uniform(0, 5), 1)
            return {
                "kind": "status",
                "t": t,
                "node": mate,
                "battery": 0.87,
                "air_bar": air,
                "motionless_s": still,
            }


def batch_bodies(count: int, t: float) -> list[bytes]:
    """`BODIES` telemetry bodies of `count` readings each, with names of `NAME_LENGTH` digits.

    Args:
        count: readings in each.
        t: time of sending, Unix seconds.
    """
    return [
        b'{"gateway":"engine-%02d","batch":"%0*d","sent":%.3f,"readings":%s}'
        % (seed % GATEWAYS, NAME_LENGTH, 0, t, readings_json(count, t, seed))
        for seed in range(BODIES)
    ]


def name_place(body: bytes) -> slice:
    """Where in a body of `batch_bodies` the batch's name is."""
    start = body.index(b'"batch":"') + len(b'"batch":"')
    return slice(start, start + NAME_LENGTH)
