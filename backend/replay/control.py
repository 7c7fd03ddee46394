"""What a viewer may tell a replay."""

from typing import Annotated

import msgspec
from msgspec import Meta

from backend.replay.clock import ReplayClock
from estimator.measurements.base import EpochSeconds

SLOWEST, FASTEST = 0.1, 64.0

Speed = Annotated[float, Meta(ge=SLOWEST, le=FASTEST)]


class Control(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a viewer sends; several at once are done in this order.

    Attributes:
        seek: moment to go to, Unix seconds.
        speed: incident seconds per second.
        pause: stand still, or go on.
    """

    seek: EpochSeconds | None = None
    speed: Speed | None = None
    pause: bool | None = None


_decode = msgspec.json.Decoder(Control).decode


def understand(message: str | bytes) -> Control:
    """A message as a control.

    Raises:
        ValueError: it is none; the text says what to send.
    """
    try:
        control = _decode(message)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f'{error}: send {{"seek": T}}, {{"speed": X}} or {{"pause": true|false}}') from error
    if control == Control():
        raise ValueError('nothing is asked: send {"seek": T}, {"speed": X} or {"pause": true|false}')
    return control


def apply(control: Control, clock: ReplayClock, wall_s: float) -> None:
    """Do what a viewer asks.

    Args:
        control: what it asks.
        clock: of its replay.
        wall_s: the wall time now (s).
    """
    if control.seek is not None:
        clock.seek(control.seek, wall_s)
    if control.speed is not None:
        clock.go(control.speed, wall_s)
    if control.pause is not None:
        clock.pause(control.pause, wall_s)
