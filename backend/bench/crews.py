"""Twenty responders among a hundred breadcrumbs, five times a second: what the latency benchmark posts."""

import math
import random
from collections.abc import Sequence

import msgspec

from estimator.measurements import AnyReading, Displacement, Node, Position, Range, Rssi

RESPONDERS = 20
BREADCRUMBS = 100
RATE_HZ = 5.0
GATEWAYS = 4
WALK_MPS = 1.0
CIRCLE_M = 8.0
GRID_M = 6.0
HEARD = 3
"""Breadcrumbs that a responder ranges to, and hears, at each report."""

_encode = msgspec.json.Encoder().encode


class Crews:
    """Responders on circles over a grid of breadcrumbs.

    Args:
        t: when they begin, Unix seconds.
    """

    def __init__(self, t: float) -> None:
        self._t = t
        self._chance = random.Random(1)  # noqa: S311 - noise for a benchmark
        self._crumbs = [(GRID_M * (i % 10), GRID_M * (i // 10)) for i in range(BREADCRUMBS)]

    def introductions(self) -> list[AnyReading]:
        """The readings that make everybody known."""
        readings: list[AnyReading] = [Node(t=self._t, node="base", role="base", position_m=(0.0, 0.0, 0.0))]
        for i, (east, north) in enumerate(self._crumbs):
            readings.append(Node(t=self._t, node=f"bc{i}", role="breadcrumb"))
            readings.append(
                Position(t=self._t, node=f"bc{i}", position_m=(east, north, 0.0), sigma_m=(1.0, 1.0, 1.0))
            )
        for i in range(RESPONDERS):
            east, north = self._place(i, self._t)
            readings.append(
                Node(t=self._t, node=f"ff{i}", role="responder", callsign=f"E{i}", crew=f"C{i % 5}")
            )
            readings.append(
                Position(t=self._t, node=f"ff{i}", position_m=(east, north, 0.0), sigma_m=(0.5, 0.5, 0.5))
            )
        return readings

    def report(self, gateway: int, t: float) -> list[AnyReading]:
        """What a gateway's responders have to say at `t` (Unix s)."""
        readings: list[AnyReading] = []
        for i in range(gateway, RESPONDERS, GATEWAYS):
            east, north = self._place(i, t)
            was_east, was_north = self._place(i, t - 1.0 / RATE_HZ)
            step = (
                east - was_east + self._noise(0.02),
                north - was_north + self._noise(0.02),
                self._noise(0.01),
            )
            readings.append(
                Displacement(t=t, node=f"ff{i}", delta_m=step, from_t=max(self._t, t - 1.0 / RATE_HZ))
            )
            for crumb in self._nearest(east, north):
                distance_m = math.dist((east, north), self._crumbs[crumb])
                measured_m = max(0.0, distance_m + self._noise(0.1))
                readings.append(Range(t=t, a=f"ff{i}", b=f"bc{crumb}", range_m=measured_m, technology="uwb"))
                dbm = -40.0 - 20.0 * math.log10(max(distance_m, 0.5)) + self._noise(5.0)
                readings.append(Rssi(t=t, a=f"ff{i}", b=f"bc{crumb}", dbm=dbm))
        return readings

    def _place(self, responder: int, t: float) -> tuple[float, float]:
        centre_east, centre_north = 12.0 + 10.0 * (responder % 5), 12.0 + 12.0 * (responder // 5)
        angle = WALK_MPS / CIRCLE_M * (t - self._t) + responder
        return centre_east + CIRCLE_M * math.cos(angle), centre_north + CIRCLE_M * math.sin(angle)

    def _nearest(self, east: float, north: float) -> Sequence[int]:
        order = sorted(range(BREADCRUMBS), key=lambda i: math.dist((east, north), self._crumbs[i]))
        return order[:HEARD]

    def _noise(self, sigma: float) -> float:
        return self._chance.gauss(0.0, sigma)


def body(gateway: int, batch: int, readings: Sequence[AnyReading]) -> bytes:
    """A telemetry body."""
    return _encode({"gateway": f"engine-{gateway}", "batch": f"b{batch}", "readings": readings})
