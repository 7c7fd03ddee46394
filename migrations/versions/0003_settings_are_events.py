"""What an incident is set to is kept with when it was set, and after which log entry."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Create the table; older incidents are taken to have been opened with what they say now."""
    op.create_table(
        "stretches",
        sa.Column("incident", sa.Text(), nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("after_seq", sa.BigInteger(), nullable=False),
        sa.Column("since", sa.Double(), nullable=False),
        sa.Column("origin", sa.Text()),
        sa.Column("levels", sa.Text(), nullable=False),
        sa.Column("settings", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("incident", "number", name="pk_stretches"),
    )
    op.execute(
        "INSERT INTO stretches (incident, number, after_seq, since, origin, levels, settings) "
        "SELECT id, 0, 0, created, origin, levels, settings FROM incidents"
    )
