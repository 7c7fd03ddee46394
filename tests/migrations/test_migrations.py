"""The schema that migrations make is the schema that the code declares."""

import subprocess
import sys
from pathlib import Path

import msgspec
import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext

from backend.log.engine import make_engine, writing
from backend.log.incident import Origin
from backend.log.incidents import IncidentStore
from backend.log.migrate import SchemaTooNew, prepare
from backend.log.schema import metadata, snapshots
from backend.tracking.heads import MadeWith, head_of

ROOT = Path(__file__).parents[2]


def differences(url: str) -> list[object]:
    engine = make_engine(url)
    with engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_server_default": True})
        found: list[object] = compare_metadata(context, metadata)
    engine.dispose()
    return found


def execute(url: str, *statements: str) -> None:
    engine = make_engine(url)
    with writing(engine) as connection:
        for statement in statements:
            connection.execute(sa.text(statement))
    engine.dispose()


def revisions(url: str) -> list[str]:
    engine = make_engine(url)
    with engine.connect() as connection:
        found = [
            str(row[0]) for row in connection.execute(sa.text("SELECT version_num FROM alembic_version"))
        ]
    engine.dispose()
    return found


def test_a_migrated_schema_is_the_declared_schema(database_url: str) -> None:
    prepare(database_url)
    assert differences(database_url) == []


def test_the_comparison_sees_a_difference(database_url: str) -> None:
    prepare(database_url)
    execute(database_url, "ALTER TABLE batches ADD COLUMN extra INTEGER")
    assert differences(database_url) != []


def test_preparing_again_changes_nothing(database_url: str) -> None:
    prepare(database_url)
    execute(
        database_url,
        "INSERT INTO leases (incident, holder, epoch, expires) VALUES ('i', 'w', 1, 2.0)",
    )
    prepare(database_url)
    assert differences(database_url) == []
    assert revisions(database_url) == ["0003"]


def test_an_older_database_is_brought_up_to_date(database_url: str) -> None:
    # The only older state yet: a database that has been prepared, and holds nothing.
    execute(database_url, "CREATE TABLE alembic_version (version_num VARCHAR(32) NOT NULL PRIMARY KEY)")
    prepare(database_url)
    assert differences(database_url) == []
    assert revisions(database_url) == ["0003"]


def test_older_snapshots_are_taken_to_be_made_with_what_their_incidents_say(database_url: str) -> None:
    prepare(database_url)
    engine = make_engine(database_url)
    incident = IncidentStore(engine).create("x", "live", Origin(lat=59.0, lon=18.0, hae=1.5))
    execute(
        database_url,
        "DROP TABLE stretches",
        "ALTER TABLE snapshots DROP COLUMN made_with",
        "INSERT INTO snapshots (incident, seq, state) SELECT id, 0, '' FROM incidents",
        "UPDATE alembic_version SET version_num = '0001'",
    )
    prepare(database_url)
    with engine.connect() as connection:
        stored = connection.execute(sa.select(snapshots.c.made_with)).scalar_one()
    engine.dispose()
    assert differences(database_url) == []
    assert msgspec.json.decode(stored, type=MadeWith) == head_of(incident).made_with


def test_older_incidents_are_taken_to_be_opened_with_what_they_say(database_url: str) -> None:
    prepare(database_url)
    engine = make_engine(database_url)
    store = IncidentStore(engine)
    known = store.create("x", "live", Origin(lat=59.0, lon=18.0, hae=1.5), created=5.0)
    changed = store.change(known.id, {"settings": {"lag_s": 5.0}})
    execute(database_url, "DROP TABLE stretches", "UPDATE alembic_version SET version_num = '0002'")
    prepare(database_url)
    migrated = store.get(known.id)
    engine.dispose()
    (only,) = migrated.stretches
    assert (only.after_seq, only.since) == (0, 5.0)
    assert migrated.set_to(only) == migrated
    assert migrated.settings == changed.settings
    assert differences(database_url) == []


def test_a_newer_database_is_refused_with_what_to_do(database_url: str) -> None:
    prepare(database_url)
    execute(database_url, "UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(SchemaTooNew, match=r"9999.*newer") as refused:
        prepare(database_url)
    assert "Start that version" in str(refused.value)
    assert revisions(database_url) == ["9999"]


def test_processes_that_start_at_once_migrate_once(database_url: str) -> None:
    command = [
        sys.executable,
        "-c",
        "import sys; from backend.log.migrate import prepare; prepare(sys.argv[1])",
    ]
    processes = [subprocess.Popen([*command, database_url], cwd=ROOT) for _ in range(4)]
    assert [process.wait(60) for process in processes] == [0, 0, 0, 0]
    assert differences(database_url) == []
    assert revisions(database_url) == ["0003"]


def test_a_migration_that_fails_leaves_the_database_as_it_was(database_url: str) -> None:
    execute(database_url, "CREATE TABLE frames (something INTEGER)")  # in the way of the first revision
    with pytest.raises(Exception, match="frames"):
        prepare(database_url)
    engine = make_engine(database_url)
    assert set(sa.inspect(engine).get_table_names()) <= {"frames", "alembic_version"}
    engine.dispose()
