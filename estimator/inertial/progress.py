"""How far a unit's samples have been navigated, between one piece of them and the next."""

from typing import NamedTuple, Self

import numpy as np

from estimator.graph.dense import Array
from estimator.inertial.boot import Boot
from estimator.inertial.sample_rate import Clock
from estimator.inertial.stuck_sensor import initial_watch

JITTER_S, JITTER_MOST_S = 0.002, 0.05
"""By so much epochs are off that a gateway gives, before they have told; and by so much at most, where
samples follow each other all the same."""


class Navigation(NamedTuple):
    """A boot's navigation between two pieces.

    Attributes:
        t: end of its newest sample, by its own clock (s).
        told_t: end of what has been told as displacements (s).
        began_rad: what its x axis was told to face when it began.
        unsure_m2: variance of its place by what has been bridged since `told_t` (m²).
        jitter_s2: variance of the epochs that its gateway gives (s²).
        newest: its newest sample, 6 (m/s², rad/s).
        watch: what has been seen of it, see `stuck_sensor.watch_channels`.
        waiting: its newest samples which may turn out to be no readings, k × 6: they are not in `boot`.
        unplaced: samples since some were missing, m × 6, which wait for a standstill: they are not in `boot`.
        edge: how it moved before them, if the way over that gap can be told, see `short_gaps.edge_of`.
        begun: when readings begin of which a part was new, and whose last piece is still to come, n (s).
        missing: so many before these are missing, and `boot` has not been told yet.
        stretched_m: by how much its way may be too long or too short in all, for its clock's pace is not
            known (m).
        clock: how fast its samples come.
        boot: its strapdown navigation; its place counts from where it was at `told_t`.
    """

    t: float
    told_t: float
    began_rad: float
    unsure_m2: float
    jitter_s2: float
    newest: Array
    watch: Array
    waiting: Array
    unplaced: Array
    edge: Array
    begun: Array
    missing: int
    stretched_m: float
    clock: Clock
    boot: Boot

    @classmethod
    def new(cls, t: float, heading_rad: float, rate_hz: float) -> Self:
        """That of a boot of which nothing is known at `t` but what its x axis faces, and its rate is told."""
        began = t, t, heading_rad, 0.0, JITTER_S**2, np.zeros(6), initial_watch()
        empty = np.zeros((0, 6)), np.zeros((0, 6)), np.zeros(0), np.zeros(0)
        return cls(*began, *empty, 0, 0.0, Clock.new(rate_hz), Boot.new(heading_rad))
