"""Runs revisions on the connection that `backend.log.migrate` hands over.

At a desk `alembic revision --autogenerate` works on the database that FIRETHREAD_DATABASE names.
"""

import os

import sqlalchemy as sa
from alembic import context

from backend.log.engine import make_engine, writing
from backend.log.schema import metadata
from backend.settings import DATABASE_VARIABLE


def run(connection: sa.Connection) -> None:
    """Run the revisions in the connection's own transaction, on SQLite too."""
    context.configure(connection=connection, target_metadata=metadata, transactional_ddl=True)
    context.run_migrations()


handed_over = context.config.attributes.get("connection")
if handed_over is not None:
    run(handed_over)
else:
    with writing(make_engine(os.environ[DATABASE_VARIABLE])) as own:
        run(own)
