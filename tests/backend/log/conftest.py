"""A log on an empty database, once SQLite and once Postgres, and batches to put into it."""

from collections.abc import Iterator

import pytest
import sqlalchemy as sa

from backend.log.engine import make_engine
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from tests.backend.log.batches import MakeBatch


@pytest.fixture
def url(database_url: str) -> str:
    prepare(database_url)
    return database_url


@pytest.fixture
def engine(url: str) -> Iterator[sa.Engine]:
    engine = make_engine(url, checkpoints=True)
    yield engine
    engine.dispose()


@pytest.fixture
def store(engine: sa.Engine) -> IncidentStore:
    return IncidentStore(engine)


@pytest.fixture
def incident(store: IncidentStore) -> str:
    return store.create("fire", "recorded").id


@pytest.fixture
def batch(incident: str) -> MakeBatch:
    return MakeBatch(incident)
