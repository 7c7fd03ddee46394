"""What walls usually do to readings between a crew and an anchor, by the kind of readings.

What is lost to all radios, what is lost to one of them beside that, and how both change in a minute.
"""

from collections.abc import Mapping
from typing import NamedTuple

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.graph.robust import Mixture

NEVER = Mixture(outliers=0.0, shift=0.0, spread=1.0)
"""Nothing beyond what is usual in sight."""


class Usual(NamedTuple):
    """Of losses of one kind; in dB of powers, in metres of ranges.

    Attributes:
        sigma: standard deviation in sight.
        behind: how often something is lost, how much, and by how much that differs.
        walk: standard deviation of how much a loss changes in a minute.
        changes: how often it changes by more, and by how much.
    """

    sigma: float
    behind: Mixture
    walk: float
    changes: Mixture


class UsualLosses(NamedTuple):
    """Of readings of one kind.

    Attributes:
        common: what is lost to all radios (positive).
        beside: what is lost to each beside that.
        gained: standard deviation of what may be gained (dB); None: what is gained is as likely as lost.
    """

    common: Usual
    beside: Usual
    gained: float | None


USUAL_LOSSES: Mapping[int, UsualLosses] = {
    # In sight radios tell powers to 2 dB only. Behind a building's shell 14 dB are lost, and buildings differ
    # by 10 (ITU-R P.2109, traditional ones at 2.4 GHz); to radios on other sides two walls more. Nothing adds
    # power, but antennas differ.
    RSSI: UsualLosses(
        common=Usual(2.0, Mixture(0.5, 14.0, 10.0), 1.0, Mixture(0.3, 0.0, 10.0)),
        beside=Usual(2.0, Mixture(0.5, 0.0, 6.0), 1.0, Mixture(0.1, 0.0, 6.0)),
        gained=4.0,
    ),
    # A shell, and what it leads waves around, makes ranges longer by some decimetres. What all radios share
    # may be an antenna delay as well, of either sign.
    RANGE: UsualLosses(
        common=Usual(0.3, NEVER, 0.05, Mixture(0.3, 0.0, 0.4)),
        beside=Usual(0.05, Mixture(0.5, 0.0, 0.3), 0.05, Mixture(0.1, 0.0, 0.3)),
        gained=None,
    ),
}
