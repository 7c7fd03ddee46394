"""A telemetry route on a real log in SQLite."""

from collections.abc import Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.log.engine import make_engine
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from tests.backend.ingest.gateway import Field


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[sa.Engine]:
    url = f"sqlite:///{tmp_path / 'firethread.db'}"
    prepare(url)
    engine = make_engine(url, checkpoints=True)
    yield engine
    engine.dispose()


@pytest.fixture
def gateway(engine: sa.Engine) -> Field:
    return Field(engine, IncidentStore(engine))
