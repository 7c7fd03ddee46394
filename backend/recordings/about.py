"""What a log is of, as the first line of an exported file says it in its field `incident`."""

from itertools import pairwise
from typing import Any, Self, TypeVar

from pydantic import Field, ValidationError, model_validator

from backend.errors import Invalid, NotUnderstood
from backend.log.incident import Clock, Incident, IncidentSettings, Level, Name, Origin, Stretch, Value


class About(Value):
    """What a log does not say, and what is shown depends on.

    Attributes:
        name: of the incident; None where nobody has said it.
        clock: of the incident.
        origin: of its local coordinates, when it was opened.
        levels: its storeys then.
        settings: all of them then: what is a default today may be another one where the file is read.
        created: when it was opened, Unix seconds; None: as it is imported.
        closed: when it was closed, Unix seconds; None: it was not.
        changes: what it was set to later, each after the line with that `seq`.
    """

    name: Name | None = None
    clock: Clock = "recorded"
    origin: Origin | None = None
    levels: list[Level] = Field(default_factory=list)
    settings: IncidentSettings = Field(default_factory=IncidentSettings)
    created: float | None = None
    closed: float | None = None
    changes: list[Stretch] = Field(default_factory=list)

    @model_validator(mode="after")
    def _changes_come_in_order(self) -> Self:
        if any(then.after_seq < before.after_seq for before, then in pairwise(self.changes)):
            raise ValueError("changes of an incident come in the order of `after_seq`")
        return self

    def with_options(
        self, levels: list[Level] | None, origin: Origin | None, settings: dict[str, object]
    ) -> "About":
        """What was said, but for what is given here: that holds in all stretches.

        Raises:
            Invalid: a setting is out of bounds, or they contradict each other.
        """
        given = {"levels": levels, "origin": origin}

        def changed(was: Told) -> Told:
            try:
                merged = IncidentSettings.model_validate(was.settings.model_dump() | settings)
            except ValidationError as error:
                raise Invalid.by_field(error.errors(), ("settings",)) from error
            values = {name: value for name, value in given.items() if value is not None}
            return was.model_copy(update=values | {"settings": merged})

        return changed(self).model_copy(update={"changes": [changed(one) for one in self.changes]})


Told = TypeVar("Told", About, Stretch)


def about(incident: Incident) -> dict[str, Any] | None:
    """What the first line of its log says; None where a file that says nothing becomes the same incident."""
    opened = incident.set_to(incident.stretches[0])
    said = About.model_validate(opened.model_dump(include=set(About.model_fields)))
    if incident.stretches[1:]:
        return said.model_copy(update={"changes": incident.stretches[1:]}).model_dump()
    if said.model_copy(update={"name": None, "created": None}) == About():
        return None
    return said.model_dump(exclude={"changes"})


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
