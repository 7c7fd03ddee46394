"""Nights drawn at random hold what they are said to hold."""

from functools import cache

import numpy as np
import pytest

from estimator.measurements import Altitude, Displacement, Drop, Node, Range, Rssi
from estimator.simulate import Scenario, scenario

NIGHTS = range(12)
INSIDE_M = 2.0
"""East of the front wall."""


@cache
def drawn(name: str) -> list[Scenario]:
    return [scenario(name, seed) for seed in NIGHTS]


@pytest.fixture(scope="module", params=["search-night", "troubled-night"])
def nights(request: pytest.FixtureRequest) -> list[Scenario]:
    return drawn(request.param)


def roles(played: Scenario) -> dict[str, str]:
    return {reading.node: reading.role for reading in played.readings if isinstance(reading, Node)}


def people(played: Scenario) -> list[str]:
    return [node for node, role in roles(played).items() if role == "responder"]


def silent_s(played: Scenario, node: str) -> tuple[float, float]:
    """From when to when the longest way of `node` was that is told at once; nil to a second, if none was."""
    own = [r for r in played.readings if isinstance(r, Displacement) and r.node == node]
    longest = max(own, key=lambda r: r.t - (r.from_t or 0.0))
    return longest.from_t or 0.0, longest.t


def test_nights_differ_in_crews_and_in_what_they_carry(nights: list[Scenario]) -> None:
    crews = {len({r.crew for r in p.readings if isinstance(r, Node) and r.crew}) for p in nights}
    assert len(crews) > 1
    for kind in (Range, Altitude):
        assert {any(isinstance(r, kind) for r in p.readings) for p in nights} == {True, False}
    for role in ("anchor", "uav"):
        assert {role in roles(p).values() for p in nights} == {True, False}


def test_crews_come_out_in_between_and_change_storeys(nights: list[Scenario]) -> None:
    storeys, entries = 0, 0
    for played in nights:
        for node in people(played):
            track = played.truth[node]
            storeys = max(storeys, len(set(track.level.tolist())))
            inside = track.position_m[:, 0] > INSIDE_M
            entries = max(entries, int((np.diff(inside.astype(int)) > 0).sum()))
    assert storeys == 3
    assert entries > 1


def test_vehicles_are_told_where_they_stand(nights: list[Scenario]) -> None:
    for played in nights:
        for told in (r for r in played.readings if isinstance(r, Node) and r.role == "anchor"):
            assert told.position_m is not None
            assert told.sigma_m is not None
            off_m = np.array(told.position_m) - played.truth[told.node].position_m[0]
            assert np.linalg.norm(off_m) < 5.0 * told.sigma_m


def test_on_a_search_night_nothing_is_at_fault() -> None:
    for played in drawn("search-night"):
        dropped = [r.node for r in played.readings if isinstance(r, Drop)]
        assert all(np.ptp(played.truth[node].position_m, axis=0).max() == 0.0 for node in dropped)
        for node in people(played):
            since_s, until_s = silent_s(played, node)
            assert until_s - since_s == pytest.approx(1.0)


def test_on_troubled_nights_things_go_wrong() -> None:
    kicked = silent = rescued = 0
    for played in drawn("troubled-night"):
        dropped = [r.node for r in played.readings if isinstance(r, Drop)]
        kicked += any(np.ptp(played.truth[node].position_m[:, 0]) > 3.9 for node in dropped)
        silent += any(np.ptp(silent_s(played, node)) > 55.0 for node in people(played))
        rescued += any(node.startswith("rit") for node in people(played))
    assert min(kicked, silent, rescued) > 0
    assert max(kicked, silent, rescued) < len(NIGHTS)


def test_who_is_silent_hears_and_ranges_nobody() -> None:
    for played in drawn("troubled-night"):
        for node in people(played):
            since_s, until_s = silent_s(played, node)
            if until_s - since_s > 55.0:
                heard = [r.t for r in played.readings if isinstance(r, Range | Rssi) and r.a == node]
                assert not any(since_s + 1.0 < t < until_s - 1.0 for t in heard)
