"""What is thought of whether somebody was inside already when the log began, though he was taken to enter."""

import math

import msgspec

DOUBTED = math.log(0.001)
"""Log odds from which on it is doubted at all that he entered: one in a thousand who is a building away makes
it as unsure as it is."""

LIKELY = math.log(0.1 / 0.9)
"""Log odds from which on those who are doubted are told of, and one fix is believed rather than where they
were taken to begin: one of ten of them is a building away."""


class LateStart(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """Of one who was taken to be at the base when the log began.

    Attributes:
        odds: log odds that he was inside already; minus infinity: that is not asked.
        hint: what of that was heard at once: breadcrumbs that nobody has dropped (log likelihood).
        told: what radios of known places have said of it when they were clearest (log likelihood); None:
            he hears none.
        reach_m: how far from where he is shown he may be, if he was, along each horizontal axis (m).
        faced: what the frame of his unit was told to face then, and how surely (rad).
        led: how far his unit has led him since, in its own frame, and until when: east, north (m), epoch (s).
    """

    odds: float = -math.inf
    hint: float = 0.0
    told: float | None = None
    reach_m: float = 0.0
    faced: tuple[float, float] | None = None
    led: tuple[float, float, float] = (0.0, 0.0, -math.inf)

    @property
    def doubt_m2(self) -> float:
        """What his place is the less sure by, along each horizontal axis (m²)."""
        if self.odds <= DOUBTED:
            return 0.0
        return self.reach_m**2 / (1.0 + math.exp(-self.odds))
