"""What is sent to create and to change an incident."""

import unicodedata
from itertools import pairwise
from typing import Annotated

from pydantic import AfterValidator, Field

from backend.log.incident import (
    AgeS,
    AirBar,
    Clock,
    IncidentSettings,
    LagS,
    Level,
    Origin,
    State,
    TrackerName,
    Value,
)
from backend.log.incident import Name as StoredName

BLANK_LETTERS = "\u115f\u1160\u2800\u3164\uffa0"
"""Fillers that Unicode counts among letters and symbols, and that show nothing."""


def _seen(name: str) -> str:
    if not any(unicodedata.category(c)[0] in "LNPS" and c not in BLANK_LETTERS for c in name):
        raise ValueError("nothing of this name can be seen: give it letters or digits")
    return name


def _storeys(levels: list[Level]) -> list[Level]:
    numbers = [level.level for level in levels]
    if len(set(numbers)) < len(numbers):
        raise ValueError("two levels have the same number: give each storey its own")
    in_order = sorted(levels, key=lambda level: level.level)
    for below, above in pairwise(in_order):
        if above.up_m < below.up_m:
            raise ValueError(
                f"level {above.level} is at {above.up_m:g} m, below level {below.level} at {below.up_m:g} m: "
                "give a storey with a larger number a larger up_m, or change the numbers"
            )
    for level in in_order:
        _seen(level.name)
    return in_order


# What is stored may be older than these: a name or levels that were taken once can still be read.
Name = Annotated[StoredName, AfterValidator(_seen)]
Levels = Annotated[list[Level], Field(max_length=100), AfterValidator(_storeys)]


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
    low_air_bar: AirBar = Field(default_factory=float)


class IncidentChange(Value):
    """What is to be changed; fields that are not sent stay as they are."""

    name: Name = Field(default_factory=str)
    state: State = Field(default_factory=lambda: "active", description="`closed` is for good")
    origin: Origin | None = Field(default_factory=lambda: None, description="null takes it away")
    levels: Levels = Field(default_factory=list, description="replaces all levels")
    settings: SettingsChange = Field(default_factory=SettingsChange)
