"""What is sent to create and to change an incident."""

from typing import Annotated

from pydantic import AfterValidator, Field

from backend.log.incident import (
    AgeS,
    Clock,
    IncidentSettings,
    LagS,
    Level,
    Name,
    Origin,
    State,
    TrackerName,
    Value,
)


def _distinct(levels: list[Level]) -> list[Level]:
    numbers = [level.level for level in levels]
    if len(set(numbers)) < len(numbers):
        raise ValueError("two levels have the same number: give each storey its own")
    return sorted(levels, key=lambda level: level.level)


Levels = Annotated[list[Level], Field(max_length=100), AfterValidator(_distinct)]


class NewIncident(Value):
    """An incident to be created."""

    name: Name
    clock: Clock
    origin: Origin | None = None
    levels: Levels = Field(default_factory=list)
    settings: IncidentSettings = Field(default_factory=IncidentSettings)


# Fields of a change have default factories, which the OpenAPI document does not show: what is not sent stays
# as it is, and null is no value for most of them.


class SettingsChange(Value):
    """Settings to be changed; those that are not sent stay."""

    stale_after_s: AgeS = Field(default_factory=float)
    lost_after_s: AgeS = Field(default_factory=float)
    static_stale_after_s: AgeS = Field(default_factory=float)
    static_lost_after_s: AgeS = Field(default_factory=float)
    lag_s: LagS = Field(default_factory=float)
    tracker: TrackerName = Field(default_factory=lambda: "kirchhoff")


class IncidentChange(Value):
    """What is to be changed; fields that are not sent stay as they are."""

    name: Name = Field(default_factory=str)
    state: State = Field(default_factory=lambda: "active", description="`closed` is for good")
    origin: Origin | None = Field(default_factory=lambda: None, description="null takes it away")
    levels: Levels = Field(default_factory=list, description="replaces all levels")
    settings: SettingsChange = Field(default_factory=SettingsChange)
