"""One alarm of one node: a call stands until a person has acknowledged it and it is cleared. A pure fold.

    raised ──acknowledged──▶ acknowledged ──cleared──▶ over
       └────────cleared────▶ cleared, shown ──acknowledged──▶ over

Acknowledging and clearing count in the order of the log, not by their epochs: a tablet whose clock is behind
must still be able to acknowledge.
"""

from collections.abc import Sequence
from typing import Self

import msgspec

from estimator.measurements import Alarm, AnyReading
from estimator.measurements.status import AlarmKind, AlarmState

REPEAT_S = 30.0
"""Units repeat an alarm while it sounds: a raise so soon after the last one is the same alarm."""

CALLS: frozenset[AlarmKind] = frozenset({"mayday", "pass", "help"})
"""By these a responder calls for help. `evacuate` is an order to it, and over as soon as it is lifted."""

EPOCHS_KEPT = 64
"""Of calls heard: what comes again by another way is known by its epoch."""

TEXTS_KEPT = 8
"""A unit may say something new each time it repeats itself: the first words and the newest are kept."""


class AlarmEntry(msgspec.Struct):
    """An alarm of a node, also after it is over.

    Attributes:
        state: what it is now.
        t: when it was raised, Unix seconds; where it was answered before it was heard of, when that was.
        called_t: when it was last raised, or raised again, Unix seconds; None: never heard of.
        acknowledged: a person has acknowledged it since it was raised.
        texts: what was said, by whomever, in the order in which it came.
        heard: epochs of the calls that were heard, Unix seconds.
    """

    state: AlarmState
    t: float
    called_t: float | None = None
    acknowledged: bool = False
    texts: list[str] = msgspec.field(default_factory=list)
    heard: list[float] = msgspec.field(default_factory=list)

    @classmethod
    def first(cls, reading: Alarm) -> Self:
        """The entry of an alarm that was never heard of before."""
        entry = cls(reading.state, reading.t, acknowledged=reading.state == "acknowledged")
        if reading.state == "raised":
            entry.called_t = reading.t
            entry.heard.append(reading.t)
        entry._say(reading.text)
        return entry

    def hear(self, reading: Alarm) -> None:
        """Take in what was said of it next."""
        if reading.state == "raised":
            self._call(reading)
            return
        if reading.state == "acknowledged":
            self.acknowledged = True
            if self.state == "cleared":
                return  # it is over with that, or was: an acknowledgement that comes late opens nothing
        self.state = reading.state
        self._say(reading.text)

    def stands(self, kind: AlarmKind) -> bool:
        """Whether it is shown: silence is not acknowledgement, and neither is the unit's own clearing.

        Args:
            kind: of alarm.
        """
        if self.state != "cleared":
            return True
        return kind in CALLS and self.called_t is not None and not self.acknowledged

    @property
    def text(self) -> str | None:
        """All that was said, a line each; None where nothing was."""
        return "\n".join(self.texts) or None

    def _call(self, reading: Alarm) -> None:
        last_t = self.t if self.called_t is None else self.called_t
        known = reading.t in self.heard
        if not known:
            self.heard.append(reading.t)
            del self.heard[:-EPOCHS_KEPT]
        # Made before the one that was answered, and never heard: its unit was offline, or its clock was
        # put back since. Nobody has answered it.
        unheard = not known and self.called_t is not None and reading.t < self.t - REPEAT_S
        if known or (reading.t <= last_t and not unheard):
            if self.called_t is None:
                # The answer came by a quicker way than the call.
                self.t = self.called_t = reading.t
                self._say(reading.text)
            return
        new_words = bool(reading.text) and reading.text not in self.texts
        still_sounding = not unheard and reading.t - last_t <= REPEAT_S
        answered = self.state == "acknowledged" and (new_words or not still_sounding)
        if self.state == "cleared" or answered:
            if not self.stands(reading.alarm):
                self.texts = []
            self.state, self.t, self.acknowledged = "raised", reading.t, False
        elif unheard:
            return  # the one that stands is the newer one
        self.called_t = reading.t
        self._say(reading.text)

    def _say(self, text: str | None) -> None:
        """Keep what was said beside what was said before: whoever answers must not wipe out where to go."""
        if text and text not in self.texts:
            self.texts.append(text)
            if len(self.texts) > TEXTS_KEPT:
                del self.texts[1]


def alarms_heard(readings: Sequence[AnyReading], came_t: float | None) -> Sequence[AnyReading]:
    """Readings, with alarms from clocks that are ahead as of when they came (Unix s; None: not known)."""
    if came_t is None or not any(isinstance(reading, Alarm) and reading.t > came_t for reading in readings):
        return readings
    return [
        msgspec.structs.replace(reading, t=came_t)
        if isinstance(reading, Alarm) and reading.t > came_t
        else reading
        for reading in readings
    ]
