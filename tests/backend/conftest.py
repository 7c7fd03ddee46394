"""A database for tests of the backend."""

from collections.abc import Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.log.engine import make_engine
from backend.log.migrate import prepare


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[sa.Engine]:
    """Of an empty SQLite database; packages that need another one have their own."""
    url = f"sqlite:///{tmp_path / 'firethread.db'}"
    prepare(url)
    engine = make_engine(url)
    yield engine
    engine.dispose()
