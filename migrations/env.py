"""Runs revisions on the connection that `backend.log.migrate` hands over; revisions are written by hand."""

from alembic import context

# In the connection's own transaction, on SQLite too.
context.configure(connection=context.config.attributes["connection"], transactional_ddl=True)
context.run_migrations()
