"""When late readings go on coming: which ticks are folded as they should be, and which in a hurry.

To fold anew all that came after a late reading is worth its while now and then. A gateway that is always
50 s behind asks for it each second, and nobody's picture would keep up (decision 0052). Where there are many
people, neither would it when a gateway comes back once (decision 0111); what has been held back is foreseen
(decision 0114).
"""

import msgspec

from estimator.inertial.samples import AnyFolded
from estimator.measurements.node import Node

PROMPT_TICKS = 4
"""Readings late by fewer ticks are folded anew at once, however often they come."""

REFOLDED_PER_TICK = 4
"""Ticks that may be folded anew for each tick of incident time, in the long run: what leaves the bucket."""

BACKLOG_TICKS = 60
"""Ticks folded anew beyond that before there is a hurry: a whole lag, as when a gateway comes back."""

BACKLOG_WORK = 80
"""The same in ticks times people, where there are more than one: each has a way of his own, with images of it
to be asked about, and each solution with all of them takes longer."""

FOLLOWED_PER_TICK = 2
"""Ticks by which the sure chain follows for each tick that incident time goes on."""

WAITED_TICKS = 20
"""Ticks for which it waits where a hurry begins: what was held back comes within seconds, and each picture of
those costs most."""


class CatchUp(msgspec.Struct, array_like=True):
    """A leaky bucket of ticks folded anew: filled by late readings, emptied as incident time goes on.

    It is a function of these alone, not of when anything was asked.

    Attributes:
        now: tick of incident time; None before the first reading.
        pending: ticks that what came late since `now` began has to have folded anew.
        backlog: ticks folded anew so far, less what is paid, and at most twice `BACKLOG_TICKS`.
        front: in a hurry, the tick up to which the sure chain goes; None: there is no hurry.
        since: where the chain that is shown leaves the sure one.
        until: up to which tick it was folded in a hurry.
        people: responders who were introduced.
        waits: ticks for which the sure chain still waits.
        heard: the newest tick in which each of them told something that did not come too late.
        silences: of whoever was silent for longer than a lag, the ticks between which he was.
    """

    now: int | None = None
    pending: int = 0
    backlog: int = 0
    front: int | None = None
    since: int = 0
    until: int = 0
    people: tuple[str, ...] = ()
    waits: int = 0
    heard: dict[str, int] = msgspec.field(default_factory=dict)
    silences: dict[str, tuple[int, int]] = msgspec.field(default_factory=dict)

    @property
    def allowed(self) -> int:
        """Ticks folded anew, beyond those that are paid, before there is a hurry."""
        return min(BACKLOG_TICKS, BACKLOG_WORK // max(len(self.people), 1))

    def meet(self, reading: AnyFolded) -> None:
        """Count who is introduced as a responder."""
        if isinstance(reading, Node) and reading.role == "responder" and reading.node not in self.people:
            self.people = (*self.people, reading.node)

    def hear(self, node: str, tick: int) -> None:
        """Note who has told something, and of which tick."""
        if node not in self.people:
            return
        before = self.heard.get(node, tick)
        if tick - before > BACKLOG_TICKS:
            self.silences[node] = before, tick
        self.heard[node] = max(before, tick)

    def foresee(self, node: str, tick: int, newest: int) -> bool:
        """Note that somebody told of a tick too late: where he was silent then, it was held back.

        What was held back comes in order: that which is late by a lag comes next.

        Returns:
            Whether a hurry begins with it. It does once for each silence.
        """
        if node not in self.heard or self.hurrying or self.backlog + BACKLOG_TICKS <= self.allowed:
            return False
        last = self.heard[node]
        begun, ended = self.silences.get(node, (last, newest)) if tick <= last else (last, newest)
        if not begun < tick <= ended:
            return False
        # Asked of once: whoever's readings always come too late would have everybody hurry for ever.
        self.silences.pop(node, None)
        self.heard[node] = newest
        self.waits = WAITED_TICKS
        self.front = self.since = self.until = newest - PROMPT_TICKS
        return True

    @property
    def hurrying(self) -> bool:
        """Whether there is a hurry."""
        return self.front is not None

    def advance(self, now: int, newest: int) -> None:
        """Move incident time to tick `now`; `newest` is the newest tick with readings."""
        passed = 0 if self.now is None else now - self.now
        self.now = now
        if not passed:
            return
        self.backlog = min(
            max(self.backlog + self.pending - REFOLDED_PER_TICK * passed, 0), 2 * BACKLOG_TICKS
        )
        self.pending = 0
        if self.front is not None:
            self.front += FOLLOWED_PER_TICK * max(passed - self.waits, 0)
            self.waits = max(self.waits - passed, 0)
            if self.front >= newest:
                self.front = None

    def note_reading(self, tick: int, newest: int) -> bool:
        """Note the tick of a reading that has come; `newest` is the newest tick that had readings.

        Returns:
            Whether the chain that is shown is to begin anew.
        """
        if tick > newest - PROMPT_TICKS:
            return False
        self.pending = max(self.pending, newest - tick)
        if self.front is None and self.backlog + self.pending <= self.allowed:
            return False
        if self.front is None:
            self.waits = WAITED_TICKS
        self.front = self.since = tick - 1 if self.front is None else min(self.front, tick - 1)
        self.until = newest - PROMPT_TICKS
        return True
