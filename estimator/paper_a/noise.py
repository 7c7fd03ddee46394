"""Paper A's measurement noise: P of a PDR displacement, of a range, and ranges from RSSI.

The paper calls the noises ω (relative positions) and γ (relative ranges) and gives each edge a covariance P
of its own (section IV), but prints no values. Where it reports a figure that tells one, that is used; path
loss is that of its radio's standard; the rest is assumed, as each constant says. No value is fitted.
"""

from math import log, log10, sqrt

from estimator.measurements.node import Role

PDR_SHARE = 0.073 / sqrt(2.0)
"""ω: section IV-F has a PDR's error grow linearly with the way travelled, and section V-A gives 7.3 m after a
round of 100 m: so much of the way along each axis. (At the end of its 400 m it is 35 m: 8.8 %.) An error that
grows with the root of the way instead, from the same figure, leaves the simulated 400 m at a mean of 10.9 m
instead of 6.7 m; section V-A's P_PDR ≤ P_RSSI that holds only at first speaks for growth too."""
PDR_FLOOR_M = 0.01
FASTEST_MPS = 5.0
"""Section IV-F: no firefighter moves faster, and a measurement that says so is dropped."""
UNREPORTED_M_PER_ROOT_S: dict[str, float] = {"responder": 2.0, "uav": 10.0}
"""How far a mobile node may have got in a time of which no displacement tells."""

NEAR_M = 1.5
NEAR_SIGMA_M = 0.5
"""Section V-B: ranges within 1.5 m are relatively accurate, even in fire: assumed, to a third of it."""
SHADOWING_DB = 6.0
"""γ of a range from RSSI grows with it, as a spread in dB does: assumed, 5 to 7 dB is usual indoors."""
RANGE_SIGMA_M = 0.5
"""γ of a range that another radio measured and gave without sigma (assumed; so are those below)."""

DROP_SIGMA_M = 0.3
"""A breadcrumb falls from the dispenser beside the foot."""
PLACED_SIGMA_M: dict[str, float] = {"anchor": 0.05}
PLACED_SIGMA_OTHER_M = 0.5
"""Of a position that a `node` reading gives without sigma."""
FIX_SIGMA_M = (3.0, 3.0, 5.0)
"""Of a GPS fix without sigma."""
ENTRY_SIGMA_M = (3.0, 3.0, 1.0)
"""A firefighter whose first position nobody gives enters at the base."""
SIGMA_FLOOR_M, SIGMA_CEILING_M = 0.01, 1e5
"""Nothing is believed to be better, and nothing is farther away."""

POWER_DBM = -40.0
"""Received at 1 m: section V-A takes more than −40 dB as a distance of about or less than 1 m."""
BREAK_M, INDOOR_EXPONENT, OPEN_EXPONENT = 8.0, 3.3, 2.0
"""IEEE 802.15.4 (Zigbee, which the paper uses), annex E: exponent 2 up to 8 m, 3.3 beyond."""
REACH_M = (0.3, 100.0)
"""A foot beside a breadcrumb, and the farthest a Zigbee radio is heard."""


def within_limits(sigma_m: float) -> float:
    """A standard deviation that can be worked with (m)."""
    return min(max(sigma_m, SIGMA_FLOOR_M), SIGMA_CEILING_M)


def pdr_sigma_m(before_m: float, way_m: float) -> float:
    """√P per axis of a displacement, where the unit does not tell its own (m).

    An edge's noise is its own alone, so that variances add up along the way: what this displacement adds to
    the variance is what linear growth of the error asks for. At first P_PDR ≤ P_RSSI, later no more, as
    section V-A observes.

    Args:
        before_m: length of the way before (m).
        way_m: length of the displacement (m).
    """
    after_m = before_m + way_m
    return max(PDR_SHARE * sqrt(after_m**2 - before_m**2), PDR_FLOOR_M)


def unreported_sigma_m(role: Role, time_s: float) -> float:
    """√P per axis of a mobile node's way in `time_s` (s) of which no displacement tells."""
    return UNREPORTED_M_PER_ROOT_S[role] * sqrt(max(time_s, 0.0))


def range_of(dbm: float, tx_dbm: float | None) -> float:
    """The RSSI distance estimator of section III: r_ij from received power (m).

    Args:
        dbm: received power (dBm).
        tx_dbm: power sent (dBm); None: 0 dBm, usual for Zigbee.
    """
    lost_db = POWER_DBM + (tx_dbm or 0.0) - dbm
    at_break_db = 10.0 * OPEN_EXPONENT * log10(BREAK_M)
    if lost_db <= at_break_db:
        decades = lost_db / (10.0 * OPEN_EXPONENT)
    else:
        decades = log10(BREAK_M) + (lost_db - at_break_db) / (10.0 * INDOOR_EXPONENT)
    nearest, farthest = REACH_M
    return min(max(float(10.0**decades), nearest), farthest)


def rssi_sigma_m(range_m: float) -> float:
    """√P of a range from RSSI (m): a spread in dB, carried to metres at the distance measured."""
    if range_m <= NEAR_M:
        return NEAR_SIGMA_M
    exponent = OPEN_EXPONENT if range_m <= BREAK_M else INDOOR_EXPONENT
    return max(range_m * SHADOWING_DB * log(10.0) / (10.0 * exponent), NEAR_SIGMA_M)
