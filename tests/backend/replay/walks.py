"""A recorded walk to replay."""

import sqlalchemy as sa

from backend.coordination.lease import Leases
from backend.live.record import PictureRecord, RecordNode, encode
from backend.log.base import RecordedFrame
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import writing
from backend.log.incident import Clock, Incident
from backend.log.incidents import IncidentStore

SECONDS = range(100, 160)
LATE = 130
"""From this second on the readings came 20 s late."""


def recorded(engine: sa.Engine, clock: Clock) -> Incident:
    """An incident in which ff1 walked east, 1 m a second, and stood from second 140 on."""
    incident = IncidentStore(engine).create("a walk", clock)
    epoch = Leases(lambda: writing(engine), "north").acquire(incident.id)
    assert epoch is not None
    rows = [
        RecordedFrame(
            second=second,
            seq=second - 99,
            received=second + (20.2 if second >= LATE else 0.2),
            record=encode(
                PictureRecord(
                    t=second - 0.1,
                    nodes=(
                        RecordNode(node="base", role="base", t=100.0, position_m=(0.0, 0.0, 0.0)),
                        RecordNode(
                            node="ff1",
                            role="responder",
                            t=min(second, 140) - 0.1,
                            position_m=(float(second), 0.0, 0.0),
                            covariance_m2=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0),
                        ),
                    ),
                )
            ),
        )
        for second in SECONDS
        if second % 7
    ]
    SqlDerivedWriter(engine).save(incident.id, epoch, rows, None)
    return incident
