"""A boot's navigation as plain values, for snapshots: exact to the last bit."""

from estimator.graph.record import ArrayRecord, pack, unpack
from estimator.inertial.boot import Boot, Strapdown
from estimator.inertial.progress import Navigation
from estimator.inertial.sample_rate import Clock

_Plain = tuple[float, float, float, float, float, float]
_Timed = tuple[float, int, float, float, float]
NavigationRecord = tuple[_Plain, int, _Timed, list[ArrayRecord]]
"""`Navigation` in plain values."""


def record_of(navigation: Navigation) -> NavigationRecord:
    """The record of a navigation; it shares nothing with it."""
    t, told_t, began_rad, unsure_m2, jitter_s2, *arrays, missing, stretched_m, clock, boot = navigation
    rate_hz, counted, learned_s, pace, sigma, paces = clock
    held, free, *rest = boot
    plain = t, told_t, began_rad, unsure_m2, jitter_s2, stretched_m
    timed = rate_hz, counted, learned_s, pace, sigma
    return plain, missing, timed, [pack(array) for array in (paces, *arrays, *held, *free, *rest)]


def navigation_of(record: NavigationRecord) -> Navigation:
    """The navigation that a record was made of."""
    (t, told_t, began_rad, unsure_m2, jitter_s2, stretched_m), missing, timed, arrays = record
    paces, newest, watch, waiting, unplaced, edge, begun, *known = (unpack(array) for array in arrays)
    size = len(Strapdown._fields)
    held, free = Strapdown(*known[:size]), Strapdown(*known[size : 2 * size])
    boot, clock = Boot(held, free, *known[2 * size :]), Clock(*timed, paces)
    plain = t, told_t, began_rad, unsure_m2, jitter_s2
    return Navigation(
        *plain, newest, watch, waiting, unplaced, edge, begun, missing, stretched_m, clock, boot
    )
