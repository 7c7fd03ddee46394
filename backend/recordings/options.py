"""Storeys and origin as they are written on the command line."""

from pydantic import ValidationError

from backend.log.incident import Level, Origin


def parse_level(text: str) -> Level:
    """A storey from `LEVEL:NAME:UP_M`, such as `1:First floor:3.4`.

    Raises:
        ValueError: the text has another form, or a value is out of bounds.
    """
    try:
        number, name, up_m = text.split(":")
        return Level(level=int(number), name=name, up_m=float(up_m))
    except (ValueError, ValidationError) as error:
        raise ValueError(f"a level is LEVEL:NAME:UP_M, such as '1:First floor:3.4', not {text!r}") from error


def parse_origin(text: str) -> Origin:
    """The origin from `LAT,LON,HAE` (°, °, m above the ellipsoid).

    Raises:
        ValueError: the text has another form, or a value is out of bounds.
    """
    try:
        lat, lon, hae = (float(part) for part in text.split(","))
        return Origin(lat=lat, lon=lon, hae=hae)
    except (ValueError, ValidationError) as error:
        raise ValueError(f"an origin is LAT,LON,HAE in degrees and metres, not {text!r}") from error
