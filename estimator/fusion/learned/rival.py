"""Somebody's way by ranges or powers alone, the rival of the one that his unit tells: which foretells better?

A unit that is no good makes outliers of good ranges, and the Kirchhoff state is sure of a wrong place. Its
rival has a velocity that is forgotten with time, as of who has no unit, and follows the same ranges. How
likely each range was by either, before it was taken in, tells which is to be believed (Dawid, The prequential
approach, JRSS A 147, 1984). As long as the unit is believed, its rival is drawn to where it leads
(interacting multiple models, Blom and Bar-Shalom 1988). Who is not ranged is asked about by powers.
"""

import math

import msgspec
import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.graph.dense import Array
from estimator.graph.ornstein_uhlenbeck import ornstein_uhlenbeck
from estimator.graph.robust import FARTHER
from estimator.graph.symmetric import full, kalman_update, upper_of
from estimator.measurements.rssi import ANTENNA_M, DB_PER_NEPER, rssi_slope

SPELL_S = 4.0
"""What stands between two radios stays for as long as one walks through a room (`physics.SHARED_M`): a range
that comes sooner after the one before it on its link tells as much less."""
MEMORY_S = 20.0
"""How long it is remembered what a link has told."""
LEAST, MOST = -1.0, 12.0
"""Log odds that a link tells at least and at most: what it told for the unit says little of later."""
LEAST_ALL = -2.0
RARE = -4.0
"""Log odds of a unit that is no good, beforehand: one in 55."""
DOUBTED, LED_ASTRAY = -3.0, 4.0
"""Log odds up to which nothing speaks against a unit's way; and times that its variance is what was assumed:
it may be its radio, or a clock, that is wrong."""
EXCESS_M = 2.0
"""What an obstructed range is too long by on average: exponentially distributed (decision 0009)."""
WILD, WILD_M = 0.1, 30.0
"""How many of the bad ranges may be off by anything, too short as well, and by how much."""
WEAKER_DB, SPREAD_DB = physics.RSSI_NOISE.shift, physics.RSSI_NOISE.spread
"""The same of a power: by what it is off, and how widely that differs (dB)."""
POWERS_ALIKE = 2.0
"""Powers of a link share so much of their errors with those before that they tell a place as if the variance
of each were so many times as large (decision 0033)."""
OBSTRUCTED = 0.3
"""So many ranges at most are taken to be obstructed: a unit that is no good makes outliers of most."""
SPEED_MPS, FORGOTTEN_S = physics.SPEED_SIGMA_MPS["responder"][0], physics.SPEED_MEMORY_S["responder"]
LONGEST_S = 600.0
"""Nobody is followed over longer silences."""
NOTHING = 1e-9
LEAST_SHARE = 0.01
"""What is less likely is not told of."""
UNIT, LINK, EPOCH, READ, SIGMA, REST, EAST, NORTH, UP, OUTLIERS, OFF, UNSURE, EXPONENT = range(13)
"""What is told of each range between a unit's bearer and somebody else: number of the unit; of the link;
epoch (s); distance (m); sigma of its noise (m); variance by what is not known of the other end and of the
technology (m²); the other end's place, east, north (m); how much higher the bearer is (m); share of outliers;
how much longer it is than the unit's way foretells (m), and the variance of that (m²); 0. Of a power the same
in dB: how much weaker it is made by the way, and its path-loss exponent."""
TOLD = 13
T, STATE, COVARIANCE = 0, slice(1, 5), slice(5, 15)
"""Columns of a rival's way: its epoch (s), NaN: there is none; east, north (m), and both velocities (m/s);
the upper triangle of the covariance of these."""
WAY = 15


class Rival(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """Where somebody is by ranges alone, and how likely it is that his unit is no good.

    Attributes:
        way: its row, see `WAY`, in C order: of most nothing but the odds is asked.
        links: what each link tells, as `odds_of` takes it, in C order: the same.
        odds: log odds that the unit is no good.
        ranged_t: epoch of the newest range that it followed (s).
    """

    way: bytes
    links: bytes
    odds: float
    ranged_t: float = -math.inf

    @property
    def share(self) -> float:
        """Probability that the unit is no good."""
        return 1.0 / (1.0 + math.exp(-self.odds))

    @property
    def counts(self) -> bool:
        """Whether it is so likely that it is told of."""
        return self.share >= LEAST_SHARE

    def place(self, t: float) -> tuple[Array, Array]:
        """Where he is at an epoch `t` (s): east, north, 2 (m), and their covariance, 2 × 2 (m²)."""
        way = np.frombuffer(self.way)
        known = way[STATE].copy(), full(way[COVARIANCE].copy())
        state, covariance = predicted(*known, t - float(way[T]))
        return state[:2], covariance[:2, :2]

    def doubt_m2(self, place_m: Array, t: float) -> Array:
        """What it adds to the covariance of the place that the unit tells, 2 × 2 (m²): see `images.doubt_m2`.

        Args:
            place_m: where he is shown: east, north (m).
            t: at which epoch (s).
        """
        if not self.counts:
            return np.zeros((2, 2))
        there_m, unsure = self.place(t)
        off = there_m - place_m
        return np.asarray(self.share * (unsure + np.outer(off, off)))


@njit(cache=True)
def odds_of(links: Array, t: float) -> float:
    """Log odds that a unit is no good.

    The link that tells most of it does not count: a breadcrumb that was kicked contradicts any way.

    Args:
        links: what each tells, k × 3: its number; until when (s); log likelihood by the rival less that by
            the unit.
        t: at which epoch (s).
    """
    total, most = 0.0, 0.0
    for number in range(len(links)):
        told = links[number, 2] * math.exp((links[number, 1] - t) / MEMORY_S)
        total, most = total + told, max(most, told)
    return RARE + max(total - most, LEAST_ALL)


@njit(cache=True)
def predicted(x: Array, covariance: Array, since_s: float) -> tuple[Array, Array]:
    """Place and velocity and their covariance after some time; see `motion.constant_velocity.free_motion`.

    Args:
        x: east, north (m), and both velocities (m/s).
        covariance: of these, 4 × 4.
        since_s: the time (s); what was before is as unsure as now.
    """
    moved = x.copy()
    if since_s <= 0.0:
        moved[:2] += since_s * x[2:]
        return moved, covariance.copy()
    whole, noise = ornstein_uhlenbeck(FORGOTTEN_S, SPEED_MPS, SPEED_MPS, min(since_s, LONGEST_S))
    transition, added = np.empty((4, 4)), np.empty((4, 4))
    for r in range(4):
        for c in range(4):
            transition[r, c] = whole[r + r // 2, c + c // 2]
            added[r, c] = noise[r + r // 2, c + c // 2]
    return transition @ x, transition @ covariance @ transition.T + added


@njit(cache=True)
def likely(off: float, variance: float, outliers: float) -> tuple[float, float]:
    """Likelihood of what a range is off by, and of its good noise's share in it: too long, hardly too short.

    Args:
        off: measured less foretold (m).
        variance: of both (m²).
        outliers: share of obstructed ranges.
    """
    near = math.exp(-0.5 * off * off / variance)
    good = (1.0 - outliers) * near / math.sqrt(2.0 * math.pi * variance)
    longer = (math.exp(-off / EXCESS_M) if off > 0.0 else near) / EXCESS_M
    wild = math.exp(-0.5 * (off / WILD_M) ** 2) / (math.sqrt(2.0 * math.pi) * WILD_M)
    return good + outliers * ((1.0 - WILD) * longer + WILD * wild) + 1e-300, good


@njit(cache=True)
def likely_power(off_db: float, variance: float, outliers: float) -> tuple[float, float]:
    """The same of a power: what is in the way makes it weaker (`physics.RSSI_NOISE`).

    Args:
        off_db: measured less foretold (dB).
        variance: of both (dB²).
        outliers: share of obstructed powers.
    """
    good = (1.0 - outliers) * normal(off_db, variance)
    weaker = normal(off_db - WEAKER_DB, variance + SPREAD_DB**2)
    wild = normal(off_db - WEAKER_DB, variance + (FARTHER * SPREAD_DB) ** 2)
    return good + outliers * ((1.0 - WILD) * weaker + WILD * wild) + 1e-300, good


@njit(cache=True)
def normal(off: float, variance: float) -> float:
    """Density of a normal distribution."""
    return math.exp(-0.5 * off * off / variance) / math.sqrt(2.0 * math.pi * variance)


@njit(cache=True)
def follow(x: Array, upper: Array, t: float, told: Array, gains: Array) -> tuple[Array, Array, float]:
    """Let a rival follow ranges, one after the other.

    Args:
        x: see `predicted`.
        upper: its covariance's upper triangle, 10.
        t: their epoch (s).
        told: the ranges, m × `TOLD`, in order of epoch.
        gains: takes log likelihood by the rival less that by the unit of each, m.

    Returns:
        x, its covariance, 4 × 4, and their epoch (s) after them.
    """
    covariance = full(upper)
    for r in range(len(told)):
        if r == 0 or told[r, EPOCH] != t:
            x, covariance = predicted(x, covariance, told[r, EPOCH] - t)
        t, outliers, noise = told[r, EPOCH], told[r, OUTLIERS], told[r, SIGMA] ** 2
        east, north = x[0] - told[r, EAST], x[1] - told[r, NORTH]
        squared, exponent = east * east + north * north + told[r, UP] ** 2 + 1e-6, told[r, EXPONENT]
        length = math.sqrt(squared)
        read, by_m, excess, spread = length, 1.0 / length, EXCESS_M, EXCESS_M
        if exponent > 0.0:
            by_m, excess, spread = rssi_slope(squared, exponent), WEAKER_DB, SPREAD_DB
            read = -0.5 * DB_PER_NEPER * exponent * math.log(squared + ANTENNA_M**2)
        slope = np.array([east * by_m, north * by_m, 0.0, 0.0])
        across = covariance @ slope
        # Aside of the line to the radio a place that is unsure makes what is foretold bend.
        bent = 0.5 * (covariance[0, 0] + covariance[1, 1]) * by_m * min(length, 1.0)
        own = noise + told[r, REST] + bent * bent
        off, foretold = told[r, READ] - read, slope @ across
        if exponent > 0.0:
            by_rival, good = likely_power(off, foretold + own, outliers)
            by_unit, _ = likely_power(told[r, OFF], told[r, UNSURE] + noise, outliers)
        else:
            by_rival, good = likely(off, foretold + own, outliers)
            by_unit, _ = likely(told[r, OFF], told[r, UNSURE] + noise, outliers)
        gains[r] = math.log(by_rival) - math.log(by_unit)
        if exponent > 0.0:
            own += (POWERS_ALIKE - 1.0) * noise
        sure = good / by_rival
        known, odd = sure / own, (1.0 - sure) * (1.0 - WILD) / (own + spread**2)
        if known + odd < NOTHING:
            continue
        pulled = off - excess * odd / (known + odd)
        kalman_update(x, covariance, across, foretold + 1.0 / (known + odd), pulled)
    return x, covariance, t


@njit(cache=True)
def led_by_unit(
    x: Array, covariance: Array, since_s: float, place_m: Array, own: Array, share: float
) -> tuple[Array, Array]:
    """A rival some time later, drawn to where its unit leads.

    Args:
        x: see `predicted`.
        covariance: see `predicted`.
        since_s: the time (s).
        place_m: where the unit leads: east, north (m).
        own: covariance of that, 2 × 2 (m²).
        share: how far it is drawn.

    Returns:
        x, and the upper triangle of its covariance, 10.
    """
    x, covariance = predicted(x, covariance, since_s)
    for r in range(2):
        off = place_m[r] - x[r]
        for c in range(2):
            both = off * (place_m[c] - x[c])
            covariance[r, c] += share * (own[r, c] - covariance[r, c]) + share * (1.0 - share) * both
            covariance[r, 2 + c] *= 1.0 - share
            covariance[2 + c, r] *= 1.0 - share
    for r in range(2):
        x[r] += share * (place_m[r] - x[r])
    return x, upper_of(covariance)
