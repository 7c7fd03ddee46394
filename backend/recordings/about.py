"""What a log is of, as the first line of an exported file says it in its field `incident`."""

from typing import Any

from pydantic import Field, ValidationError

from backend.errors import Invalid, NotUnderstood
from backend.log.incident import Clock, Incident, IncidentSettings, Level, Name, Origin, Value


class About(Value):
    """What a log does not say, and what is shown depends on.

    Attributes:
        name: of the incident; None where nobody has said it.
        clock: of the incident.
        origin: of its local coordinates.
        levels: its storeys.
        settings: all of them: what is a default today may be another one where the file is read.
        created: when it was opened, Unix seconds; None: as it is imported.
        closed: when it was closed, Unix seconds; None: it was not.
    """

    name: Name | None = None
    clock: Clock = "recorded"
    origin: Origin | None = None
    levels: list[Level] = Field(default_factory=list)
    settings: IncidentSettings = Field(default_factory=IncidentSettings)
    created: float | None = None
    closed: float | None = None


def about(incident: Incident) -> dict[str, Any] | None:
    """What the first line of its log says; None where a file that says nothing becomes the same incident."""
    said = About.model_validate(incident.model_dump(include=set(About.model_fields)))
    if said.model_copy(update={"name": None, "created": None}) == About():
        return None
    return said.model_dump()


def understood(said: dict[str, Any] | None) -> About:
    """The inverse of `about`.

    Raises:
        NotUnderstood: a value is out of bounds, or of a newer version.
    """
    try:
        return About.model_validate(said or {})
    except ValidationError as error:
        faults = Invalid.by_field(error.errors())
        raise NotUnderstood(f"What is said of the incident is not understood: {faults.detail}.") from error
