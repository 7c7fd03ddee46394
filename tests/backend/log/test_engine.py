from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.errors import CommandRefused
from backend.log.base import LogUnreadable, LogUnwritable
from backend.log.engine import make_engine, reading, writing


def pragma(engine: sa.Engine, name: str) -> object:
    with reading(engine) as connection:
        return connection.exec_driver_sql(f"PRAGMA {name}").scalar()


def test_sqlite_keeps_what_it_acknowledged_through_a_loss_of_power(tmp_path: Path) -> None:
    engine = make_engine(f"sqlite:///{tmp_path / 'x.db'}")
    assert pragma(engine, "journal_mode") == "wal"
    assert pragma(engine, "synchronous") == 2
    assert pragma(engine, "mmap_size") in {0, None}


def test_only_the_process_that_appends_checkpoints(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'x.db'}"
    assert pragma(make_engine(url), "wal_autocheckpoint") == 0
    assert pragma(make_engine(url, checkpoints=True), "wal_autocheckpoint") > 0  # type: ignore[operator]


def test_postgres_commits_synchronously_whatever_its_own_default(postgres_url: str) -> None:
    engine = make_engine(postgres_url)
    with reading(engine) as connection:
        assert connection.exec_driver_sql("SHOW synchronous_commit").scalar() == "on"
    engine.dispose()


def test_a_database_that_cannot_be_reached_is_said_to_be_away(tmp_path: Path) -> None:
    for url in (f"sqlite:///{tmp_path}/no/such/folder/x.db", "postgresql+psycopg://127.0.0.1:1/nothing"):
        engine = make_engine(url)
        with pytest.raises(LogUnwritable), writing(engine):
            pass
        with pytest.raises(LogUnreadable), reading(engine):
            pass


def test_a_file_that_is_no_database_is_said_to_be_away(tmp_path: Path) -> None:
    (tmp_path / "x.db").write_bytes(b"a photo of the stairs" * 1000)
    engine = make_engine(f"sqlite:///{tmp_path / 'x.db'}")
    with pytest.raises(LogUnwritable, match="not a database"), writing(engine):
        pass
    with pytest.raises(LogUnreadable, match="not a database"), reading(engine):
        pass


def test_a_damaged_file_is_said_to_be_away(tmp_path: Path) -> None:
    path = tmp_path / "x.db"
    engine = make_engine(f"sqlite:///{path}")
    with writing(engine) as connection:
        connection.exec_driver_sql("CREATE TABLE batches (body TEXT)")
        connection.exec_driver_sql("INSERT INTO batches VALUES (hex(zeroblob(20000)))")
    engine.dispose()
    with path.open("r+b") as file:
        file.seek(4096)
        file.write(b"\xff" * 8192)
    with pytest.raises(LogUnreadable, match="malformed"), reading(engine) as connection:
        connection.exec_driver_sql("SELECT count(body) FROM batches").scalar()


def test_nothing_is_written_to_a_file_that_is_not_in_its_place_and_what_it_holds_is_read(
    tmp_path: Path,
) -> None:
    path, elsewhere = tmp_path / "x.db", tmp_path / "y.db"
    engine = make_engine(f"sqlite:///{path}")

    def write() -> None:
        with writing(engine) as connection:
            connection.exec_driver_sql("INSERT INTO batches VALUES (NULL)")

    with writing(engine) as connection:
        connection.exec_driver_sql("CREATE TABLE batches (seq INTEGER PRIMARY KEY)")
    write()
    path.rename(elsewhere)
    with pytest.raises(LogUnwritable, match="deleted, moved or replaced"):
        write()
    path.touch()
    with pytest.raises(LogUnwritable, match="deleted, moved or replaced"):
        write()
    with reading(engine) as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM batches").scalar() == 1
    elsewhere.rename(path)
    write()
    with reading(engine) as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM batches").scalar() == 2


def test_what_is_asked_wrongly_is_a_defect_and_no_failure_of_the_database(tmp_path: Path) -> None:
    engine = make_engine(f"sqlite:///{tmp_path / 'x.db'}")
    with writing(engine) as connection:
        connection.exec_driver_sql("CREATE TABLE batches (seq INTEGER PRIMARY KEY)")
        connection.exec_driver_sql("INSERT INTO batches VALUES (1)")
    with pytest.raises(sa.exc.IntegrityError), writing(engine) as connection:
        connection.exec_driver_sql("INSERT INTO batches VALUES (1)")


def test_another_kind_of_database_is_refused() -> None:
    with pytest.raises(CommandRefused, match="SQLite or Postgres"):
        make_engine("mysql://127.0.0.1/x")
