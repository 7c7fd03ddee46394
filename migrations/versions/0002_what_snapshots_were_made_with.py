"""Snapshots tell which tracker made them, and what it had been told."""

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"

incidents = sa.table("incidents", sa.column("id"), sa.column("settings"), sa.column("origin"))
snapshots = sa.table("snapshots", sa.column("incident"), sa.column("made_with"))


def upgrade() -> None:
    """Add the column; snapshots that are there are taken to be made with what their incidents say now."""
    column = sa.Column("made_with", sa.Text())
    connection = op.get_bind()
    if connection.dialect.name == "sqlite":
        # Behind `state` it could only be read by way of all its pages.
        with op.batch_alter_table("snapshots", recreate="always") as batch:
            batch.add_column(column, insert_after="seq")
    else:
        op.add_column("snapshots", column)
    for row in connection.execute(
        sa.select(incidents).join(snapshots, incidents.c.id == snapshots.c.incident)
    ):
        made_with = json.dumps(_made_with(json.loads(row.settings), json.loads(row.origin or "null")))
        connection.execute(
            sa.update(snapshots).where(snapshots.c.incident == row.id).values(made_with=made_with)
        )


def _made_with(settings: dict[str, Any], origin: dict[str, float] | None) -> dict[str, object]:
    place = None if origin is None else [origin["lat"], origin["lon"], origin["hae"]]
    return {
        "tracker": settings["tracker"],
        "settings": {"lag_s": settings["lag_s"], "origin_wgs84": place},
    }
