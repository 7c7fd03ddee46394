"""What a telemetry route would be without further thought: declared models, a row a reading.

FastAPI with a discriminated union of pydantic models, and SQLAlchemy with one INSERT a batch of one row for
each reading, committed with the same durability. It keeps no bytes as they came, knows no duplicates, and
refuses a batch for one bad reading. Only the benchmark uses it.
"""

import os
import threading
from typing import Annotated, Literal

import sqlalchemy as sa
from fastapi import FastAPI
from pydantic import BaseModel, ConfigDict, Field, model_validator

from backend.log.engine import make_engine, writing

Name = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[A-Za-z0-9_.:-]+$")]
Metres = Annotated[float, Field(ge=-100_000, le=100_000)]
Sigma = Annotated[float, Field(gt=0, le=100_000)]


class Reading(BaseModel):
    """What all readings share."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)
    t: float = Field(ge=0, le=4_102_444_800)


class Displacement(Reading):
    """A displacement."""

    kind: Literal["displacement"]
    node: Name
    delta_m: tuple[Metres, Metres, Metres]
    from_t: float | None = None
    heading_rad: float | None = None
    sigma_m: Sigma | None = None


class Pair(Reading):
    """A reading between two nodes."""

    a: Name
    b: Name

    @model_validator(mode="after")
    def _two(self) -> "Pair":
        if self.a == self.b:
            raise ValueError("a node cannot measure itself")
        return self


class Range(Pair):
    """A range."""

    kind: Literal["range"]
    range_m: float = Field(ge=0, le=100_000)
    sigma_m: Sigma | None = None
    technology: Name | None = None


class Rssi(Pair):
    """A received power."""

    kind: Literal["rssi"]
    dbm: float = Field(ge=-200, le=100)
    tx_dbm: float | None = None


class Pressure(Reading):
    """An air pressure."""

    kind: Literal["pressure"]
    node: Name
    pressure_pa: float = Field(ge=10_000, le=200_000)
    sigma_m: Sigma | None = None


class Status(Reading):
    """A status."""

    kind: Literal["status"]
    node: Name
    battery: float | None = Field(default=None, ge=0, le=1)
    air_bar: float | None = Field(default=None, ge=0, le=1_000)
    motionless_s: float | None = Field(default=None, ge=0)


class Batch(BaseModel):
    """A batch."""

    gateway: Name
    batch: Name
    sent: float | None = None
    readings: list[Annotated[Displacement | Range | Rssi | Pressure | Status, Field(discriminator="kind")]]


class Receipt(BaseModel):
    """The answer."""

    batch: str
    accepted: int


metadata = sa.MetaData()
rows = sa.Table(
    "readings",
    metadata,
    sa.Column("id", sa.Integer, primary_key=True),
    sa.Column("incident", sa.Text, nullable=False),
    sa.Column("gateway", sa.Text, nullable=False),
    sa.Column("batch", sa.Text, nullable=False),
    sa.Column("kind", sa.Text, nullable=False),
    sa.Column("t", sa.Double, nullable=False),
    sa.Column("reading", sa.JSON, nullable=False),
)
engine = make_engine(os.environ.get("FIRETHREAD_BENCH_DATABASE", "sqlite://"), checkpoints=True)
one_at_a_time = threading.Lock()
app = FastAPI()


@app.post("/api/v1/incidents/{incident}/telemetry", status_code=202)
def post_telemetry(incident: str, batch: Batch) -> Receipt:
    """Take a batch."""
    # SQLite lets one write at a time, and those who find it locked sleep: without a queue it would be slower.
    with one_at_a_time, writing(engine) as connection:
        connection.execute(
            sa.insert(rows),
            [
                {
                    "incident": incident,
                    "gateway": batch.gateway,
                    "batch": batch.batch,
                    "kind": reading.kind,
                    "t": reading.t,
                    "reading": reading.model_dump(exclude={"kind", "t"}, exclude_none=True),
                }
                for reading in batch.readings
            ],
        )
    return Receipt(batch=batch.batch, accepted=len(batch.readings))
