"""Who has been hearing whom: where a radio falls silent or is heard again, somebody crosses its reach.

But a unit may tell only the strongest few of all that it hears: then a radio falls silent because another one
has become louder, and nothing is known of its reach (decision 0117).
"""

from dataclasses import dataclass, field

import msgspec
from msgspec.structs import replace

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


@dataclass
class Heard:
    """Whom a radio hears in a second.

    Attributes:
        radios: whom, and when last (s).
        at_once: how many one scan of its tells of, at most.
    """

    radios: dict[str, float] = field(default_factory=dict)
    at_once: int = 0

    @property
    def told(self) -> int:
        """How many it tells of at once; where each power has an epoch of its own, in the whole second."""
        return self.at_once if self.at_once > 1 else len(self.radios)


class Listener(msgspec.Struct, frozen=True, array_like=True):
    """What a radio has been hearing; an occasion is a second in which it hears anything.

    Attributes:
        occasions: epochs of the last ones that are over, oldest first (s).
        told: how many radios it told of at once on each of these.
        newest: whom it hears at the newest one, and when (s): the rest of it may still be under way.
        newest_told: how many it tells of at once on that.
        radios: those that it had heard until then.
    """

    occasions: tuple[float, ...] = ()
    told: tuple[int, ...] = ()
    newest: dict[str, float] = {}
    newest_told: int = 0
    radios: dict[str, HeardRadio] = {}

    def without(self, radio: str) -> "Listener":
        """The same, as if it had never heard a radio."""
        if radio not in self.newest and radio not in self.radios:
            return self
        newest = {name: t for name, t in self.newest.items() if name != radio}
        radios = {name: heard for name, heard in self.radios.items() if name != radio}
        return replace(self, newest=newest, radios=radios)


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


def listen(name: str, listener: Listener, now: Heard, silent: int) -> Occasion:
    """Close the newest occasion of a listener, and begin the next one.

    Who is heard again is so at once. Who is not may still come, in a later post, until the occasion is over.
    Where another radio is told of in the place of one, no reach was crossed.

    Args:
        name: of the listener.
        listener: what it has been hearing.
        now: whom it hears at the next one.
        silent: occasions in a row at which a radio in reach is hardly missed by chance: where it is not heard
            at the next one either, it is out of reach.
    """
    before, radios = listener.newest, dict(listener.radios)
    if not before:
        return Occasion(Listener((), (), now.radios, now.told, radios), [], 0, 0)
    occasions = (*listener.occasions, max(before.values()))[-MOST_SILENT - 1 :]
    told = (*listener.told, listener.newest_told)[-MOST_SILENT - 1 :]
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
            if other in now.radios and other not in before and now.told > told[-1]:
                crossed(occasions[-1], now.radios[other], other)
            continue
        if other in before:
            continue
        again = other in now.radios
        missed = known.silent + 1
        # Until it is thought to be out of reach, what is not heard of it counts as lost.
        if missed < silent or again:
            lost += 1
        else:
            lost -= silent - 1
            replaced = len(occasions) <= silent or told[-silent] >= told[-silent - 1]
            if known.heard >= STREAK and not replaced:
                crossed(known.t, occasions[-silent], other)
        radios[other] = HeardRadio(known.t, known.heard, 0 if missed == silent and again else missed)
    return Occasion(Listener(occasions, told, now.radios, now.told, radios), crossings, heard, lost)
