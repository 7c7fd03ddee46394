"""What an incident is: the values that are stored, and shown on the wire as they are."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

Clock = Literal["live", "recorded"]
"""live: ages count on the server's clock; recorded: the newest reading is now."""

State = Literal["active", "closed"]
TrackerName = Literal["kirchhoff", "paper-a"]

# NUL and other control characters have no place in a name, and Postgres cannot store NUL.
Name = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^[^\x00-\x1f\x7f]+$")]
LevelName = Annotated[str, Field(min_length=1, max_length=40, pattern=r"^[^\x00-\x1f\x7f]+$")]
LagS = Annotated[float, Field(ge=0.0, le=600.0)]
AgeS = Annotated[float, Field(gt=0.0, le=86_400.0)]
AirBar = Annotated[float, Field(ge=0.0, le=1_000.0)]


class Value(BaseModel):
    """Base: unknown fields, NaN and infinities are refused, and a string is no number."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Origin(Value):
    """Where the incident's local origin is in WGS84."""

    lat: float = Field(ge=-90.0, le=90.0, description="latitude (°)")
    lon: float = Field(ge=-180.0, le=180.0, description="longitude (°)")
    hae: float = Field(ge=-1_000.0, le=10_000.0, description="height above the ellipsoid (m)")


class Level(Value):
    """A storey."""

    level: int = Field(ge=-100, le=1_000, description="its number, ground 0")
    name: LevelName = Field(description="its spoken name")
    up_m: float = Field(ge=-100_000.0, le=100_000.0, description="height of its floor (m)")


class IncidentSettings(Value):
    """What an incident may set, with the defaults."""

    stale_after_s: AgeS = Field(default=10.0, description="a responder or UAV is stale after this age (s)")
    lost_after_s: AgeS = Field(default=60.0, description="a responder or UAV is lost after this age (s)")
    static_stale_after_s: AgeS = Field(default=60.0, description="a static node is stale after this age (s)")
    static_lost_after_s: AgeS = Field(default=300.0, description="a static node is lost after this age (s)")
    lag_s: LagS = Field(default=60.0, description="readings later than this are logged, not fused (s)")
    tracker: TrackerName = Field(default="kirchhoff", description="the estimator")

    # EN 137: the whistle of a breathing apparatus sounds at (55 ± 5) bar.
    low_air_bar: AirBar = Field(default=60.0, description="a responder's air is low from here on down (bar)")

    @model_validator(mode="after")
    def _lost_comes_after_stale(self) -> Self:
        if self.lost_after_s < self.stale_after_s or self.static_lost_after_s < self.static_stale_after_s:
            raise ValueError(
                "a node cannot be lost before it is stale: raise lost_after_s or lower stale_after_s"
            )
        return self


class Stretch(Value):
    """What an incident was set to, from one change of it until the next: an event of the incident."""

    after_seq: int = Field(ge=0, description="the newest entry of its log when it was set")
    since: float = Field(description="when it was set, Unix seconds")
    origin: Origin | None
    levels: list[Level]
    settings: IncidentSettings


class Incident(Value):
    """An incident as it is stored and shown."""

    id: str
    name: Name
    clock: Clock
    state: State
    origin: Origin | None
    levels: list[Level]
    settings: IncidentSettings
    created: float = Field(description="Unix seconds")
    closed: float | None = Field(description="Unix seconds; null while it is active")
    last_seq: int = Field(ge=0, description="the newest entry of its log; 0 if it has none")
    first_t: float | None = Field(
        description="first second that can be shown, Unix seconds; null if none. On a live clock none "
        "before `earliest_t`, if there is another"
    )
    last_t: float | None = Field(description="last second that can be shown, Unix seconds; null if none")
    earliest_t: float | None = Field(
        description="on a live clock: what is told of earlier than this, 6 h before the first batch came, "
        "Unix seconds, comes from a clock that is wrong; null on a recorded one"
    )
    stretches: list[Stretch] = Field(
        min_length=1,
        description="what it was set to, and from when on: the first as it was opened, the last holds now",
    )

    def set_to(self, stretch: Stretch) -> Self:
        """The incident as it was in a stretch of its own."""
        was = {"origin": stretch.origin, "levels": stretch.levels, "settings": stretch.settings}
        return self.model_copy(update=was)
