"""A boot's navigation as plain values, for snapshots: exact to the last bit."""

from estimator.graph.record import ArrayRecord, pack, unpack
from estimator.inertial.boot import Boot, Strapdown
from estimator.inertial.navigation import Navigation

NavigationRecord = tuple[tuple[float, float, float, float, float], int, list[ArrayRecord]]
"""`Navigation` in plain values."""


def record_of(navigation: Navigation) -> NavigationRecord:
    """The record of a navigation; it shares nothing with it."""
    t, told_t, began_rad, unsure_m2, jitter_s2, newest, watch, waiting, begun, missing, boot = navigation
    held, free, *rest = boot
    plain = t, told_t, began_rad, unsure_m2, jitter_s2
    return plain, missing, [pack(array) for array in (newest, watch, waiting, begun, *held, *free, *rest)]


def navigation_of(record: NavigationRecord) -> Navigation:
    """The navigation that a record was made of."""
    plain, missing, arrays = record
    newest, watch, waiting, begun, *known = (unpack(array) for array in arrays)
    size = len(Strapdown._fields)
    held, free = Strapdown(*known[:size]), Strapdown(*known[size : 2 * size])
    return Navigation(*plain, newest, watch, waiting, begun, missing, Boot(held, free, *known[2 * size :]))
