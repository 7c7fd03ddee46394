"""Storeys, origin and settings as they are written on the command line."""

import contextlib
from collections.abc import Sequence

from pydantic import ValidationError

from backend.errors import CommandRefused
from backend.log.incident import IncidentSettings, Level, Origin


def parse_level(text: str) -> Level:
    """A storey from `LEVEL:NAME:UP_M`, such as `1:First floor:3.4`.

    Raises:
        CommandRefused: the text has another form, or a value is out of bounds.
    """
    try:
        number, name, up_m = text.split(":")
        return Level(level=int(number), name=name, up_m=float(up_m))
    except (ValueError, ValidationError) as error:
        raise CommandRefused(
            f"a level is LEVEL:NAME:UP_M, such as '1:First floor:3.4', not {text!r}"
        ) from error


def parse_origin(text: str) -> Origin:
    """The origin from `LAT,LON,HAE` (°, °, m above the ellipsoid).

    Raises:
        CommandRefused: the text has another form, or a value is out of bounds.
    """
    try:
        lat, lon, hae = (float(part) for part in text.split(","))
        return Origin(lat=lat, lon=lon, hae=hae)
    except (ValueError, ValidationError) as error:
        raise CommandRefused(f"an origin is LAT,LON,HAE in degrees and metres, not {text!r}") from error


def parse_settings(texts: Sequence[str]) -> dict[str, object]:
    """Settings from `NAME=VALUE` each, such as `lag_s=120`; whether they fit together is not looked at.

    Raises:
        CommandRefused: a text has another form, or there is no such setting.
    """
    settings: dict[str, object] = {}
    for text in texts:
        name, equals, said = text.partition("=")
        if not equals or name not in IncidentSettings.model_fields:
            known = ", ".join(IncidentSettings.model_fields)
            raise CommandRefused(
                f"a setting is NAME=VALUE, such as 'lag_s=120', not {text!r}; there are {known}"
            )
        settings[name] = said
        with contextlib.suppress(ValueError):
            settings[name] = float(said)
    return settings
