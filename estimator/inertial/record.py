"""A boot's navigation as plain values, for snapshots: exact to the last bit."""

from estimator.graph.record import ArrayRecord, pack, unpack
from estimator.inertial.boot import Strapdown
from estimator.inertial.navigation import Navigation

NavigationRecord = tuple[tuple[float, float, float, float, float], list[ArrayRecord]]
"""`Navigation` in plain values."""


def record_of(navigation: Navigation) -> NavigationRecord:
    """The record of a navigation; it shares nothing with it."""
    t, told_t, began_rad, unsure_m2, jitter_s2, newest, boot = navigation
    return (t, told_t, began_rad, unsure_m2, jitter_s2), [pack(array) for array in (newest, *boot)]


def navigation_of(record: NavigationRecord) -> Navigation:
    """The navigation that a record was made of."""
    plain, arrays = record
    newest, *boot = (unpack(array) for array in arrays)
    return Navigation(*plain, newest, Strapdown(*boot))
