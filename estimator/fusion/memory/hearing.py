"""Who has been hearing whom: where a radio falls silent or is heard again, somebody crosses its reach."""

from collections.abc import Mapping

import msgspec

from estimator.fusion.learned.reach import MOST_SILENT
from estimator.measurements.base import PairReading

STREAK = 3
"""Occasions in a row at which a radio must have been heard before it can fall silent."""
GAP_S = 1.5
"""Between occasions farther apart nobody knows when the reach was crossed."""


class Crossing(PairReading, tag="crossing", frozen=True):
    """`a` came into the reach of `b`, or left it: `t` is in the middle between two occasions."""


class HeardRadio(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """One radio as another hears it.

    Attributes:
        t: when it was heard last (s).
        heard: occasions in a row at which it was heard, until it fell silent.
        silent: occasions in a row since, until it is out of reach.
    """

    t: float
    heard: int
    silent: int


class Listener(msgspec.Struct, frozen=True, array_like=True):
    """What a radio has been hearing; an occasion is a second in which it hears anything.

    Attributes:
        occasions: epochs of the last ones that are over, oldest first (s).
        newest: whom it hears at the newest one, and when (s): the rest of it may still be under way.
        radios: those that it had heard until then.
    """

    occasions: tuple[float, ...] = ()
    newest: dict[str, float] = {}
    radios: dict[str, HeardRadio] = {}

    def without(self, radio: str) -> "Listener":
        """The same, as if it had never heard a radio."""
        if radio not in self.newest and radio not in self.radios:
            return self
        newest = {name: t for name, t in self.newest.items() if name != radio}
        radios = {name: heard for name, heard in self.radios.items() if name != radio}
        return Listener(self.occasions, newest, radios)


class Occasion(msgspec.Struct, frozen=True):
    """What an occasion tells once it is over, and the next one that has begun.

    Attributes:
        listener: what the radio has been hearing.
        crossings: of reaches.
        heard: packets from radios that were in reach before.
        lost: how many more seem to have been lost.
    """

    listener: Listener
    crossings: list[Crossing]
    heard: int
    lost: int


def listen(name: str, listener: Listener, now: Mapping[str, float], silent: int) -> Occasion:
    """Close the newest occasion of a listener, and begin the next one.

    Who is heard again is so at once. Who is not may still come, in a later post, until the occasion is over.

    Args:
        name: of the listener.
        listener: what it has been hearing.
        now: whom it hears at the next one, and when (s).
        silent: occasions in a row at which a radio in reach is hardly missed by chance: where it is not heard
            at the next one either, it is out of reach.
    """
    before, radios = listener.newest, dict(listener.radios)
    if not before:
        return Occasion(Listener((), dict(now), radios), [], 0, 0)
    occasions = (*listener.occasions, max(before.values()))[-MOST_SILENT:]
    crossings: list[Crossing] = []
    heard = lost = 0

    def crossed(since_t: float, until_t: float, other: str) -> None:
        if until_t - since_t <= GAP_S:
            crossings.append(Crossing(t=0.5 * (since_t + until_t), a=name, b=other))

    for other, t in before.items():
        known = radios.get(other)
        if known is None or known.silent >= silent:
            radios[other] = HeardRadio(t, 1, 0)
        else:
            heard += 1
            radios[other] = HeardRadio(t, known.heard + 1, 0)
    for other, known in listener.radios.items():
        if known.silent >= silent:
            # Of the many that are out of reach nothing changes until they are heard again.
            if other in now and other not in before:
                crossed(occasions[-1], now[other], other)
            continue
        if other in before:
            continue
        again = other in now
        missed = known.silent + 1
        # Until it is thought to be out of reach, what is not heard of it counts as lost.
        if missed < silent or again:
            lost += 1
        else:
            lost -= silent - 1
            if known.heard >= STREAK and len(occasions) >= silent:
                crossed(known.t, occasions[-silent], other)
        radios[other] = HeardRadio(known.t, known.heard, 0 if missed == silent and again else missed)
    return Occasion(Listener(occasions, dict(now), radios), crossings, heard, lost)
