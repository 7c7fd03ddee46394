"""Brings a database to the schema of this version, at start."""

from importlib.resources import as_file, files

import sqlalchemy as sa
from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory

from backend.errors import CommandRefused
from backend.log.base import LogUnwritable
from backend.log.engine import cause_of, make_engine, writing

_POSTGRES_LOCK = 0x46495245
"""Any number, the same in every version: it keeps two processes from migrating at once."""


class SchemaTooNew(CommandRefused):
    """The database was written by a newer version."""


def prepare(url: str) -> None:
    """Create the tables, or bring those of an older version up to this one, in one transaction.

    Two processes may do so at once: the second waits, and finds the work done.

    Args:
        url: of the log's database.

    Raises:
        SchemaTooNew: a newer version has written it; the message says what to do.
        LogUnwritable: the database cannot be reached or written.
    """
    engine = make_engine(url)
    try:
        with as_file(files("migrations")) as folder, writing(engine) as connection:
            if connection.dialect.name == "postgresql":
                connection.execute(sa.select(sa.func.pg_advisory_xact_lock(_POSTGRES_LOCK)))
            config = Config()
            config.set_main_option("script_location", str(folder).replace("%", "%%"))
            config.attributes["connection"] = connection
            _refuse_newer(connection, ScriptDirectory.from_config(config), engine.url)
            command.upgrade(config, "head")
    except LogUnwritable as error:
        shown = engine.url.render_as_string(hide_password=True)
        why = cause_of(error.__cause__ or error)
        raise LogUnwritable(
            f"The database {shown} cannot be opened: {why}. Check --data or --database, and whether it is up."
        ) from error
    finally:
        engine.dispose()


def _refuse_newer(connection: sa.Connection, scripts: ScriptDirectory, url: sa.URL) -> None:
    present = MigrationContext.configure(connection).get_current_revision()
    known = {script.revision for script in scripts.walk_revisions()}
    if present is not None and present not in known:
        raise SchemaTooNew(
            f"The database {url.render_as_string(hide_password=True)} has schema revision {present}, which "
            "this version of Firethread does not know: a newer one has written it. Start that version, or "
            "give another folder or database."
        )
