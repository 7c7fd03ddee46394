"""When late readings go on coming: which ticks are folded as they should be, and which in a hurry.

To fold anew all that came after a late reading is worth its while now and then. A gateway that is always
50 s behind asks for it each second, and nobody's picture would keep up (decision 0052).
"""

import msgspec

SOON = 4
"""Ticks: what is late by less is folded anew as it should be, however often."""

PAID = 4
"""Ticks that may be folded anew for each tick that incident time goes on, in the long run."""

OWED = 60
"""Ticks folded anew beyond that until there is a hurry: a whole lag, as when a gateway comes back."""

FOLLOWED = 2
"""Ticks by which the sure chain follows for each tick that incident time goes on."""


class CatchUp(msgspec.Struct, array_like=True):
    """A fold over ticks: of each reading's, and of incident time. It knows nothing of what was asked when.

    Attributes:
        now: tick of incident time; None before the first reading.
        again: ticks that what came late since `now` began has to have folded anew.
        owed: ticks folded anew so far, less what is paid, and at most twice `OWED`.
        front: in a hurry, the tick up to which the sure chain goes; None: there is no hurry.
        since: where the chain that is shown leaves the sure one.
        until: up to which tick it was folded in a hurry.
    """

    now: int | None = None
    again: int = 0
    owed: int = 0
    front: int | None = None
    since: int = 0
    until: int = 0

    @property
    def on(self) -> bool:
        """There is a hurry."""
        return self.front is not None

    def go_on(self, now: int, newest: int) -> None:
        """Let incident time be at tick `now`; `newest` is the newest that has readings."""
        passed = 0 if self.now is None else now - self.now
        self.now = now
        if not passed:
            return
        self.owed = min(max(self.owed + self.again - PAID * passed, 0), 2 * OWED)
        self.again = 0
        if self.front is not None:
            self.front += FOLLOWED * passed
            if self.front >= newest:
                self.front = None

    def comes(self, tick: int, newest: int) -> bool:
        """Take note of a reading's tick; `newest` is the newest that had readings.

        Returns:
            The chain that is shown begins anew.
        """
        if tick > newest - SOON:
            return False
        self.again = max(self.again, newest - tick)
        if self.front is None and self.owed + self.again <= OWED:
            return False
        self.front = self.since = tick - 1 if self.front is None else min(self.front, tick - 1)
        self.until = newest - SOON
        return True
