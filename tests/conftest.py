"""Fixtures that tests of several packages share."""

import os
from collections.abc import Generator, Iterator
from pathlib import Path
from uuid import uuid4

import hypothesis
import pytest
import sqlalchemy as sa

from tests.needs import missing
from tests.running import Post, Server, close_all, running

# As the server and the worker do, before anything imports numpy: the threads of a matrix of a few rows wait
# for each other for longer than they reckon, and those of one test keep the next one from its processor.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

# The gate tries the same examples each time: it speaks of the change, not of luck. At a desk they vary.
hypothesis.settings.register_profile("gate", derandomize=True, deadline=None)
hypothesis.settings.register_profile("desk", deadline=None)
hypothesis.settings.load_profile("gate" if os.environ.get("CI") else "desk")

ROOT = Path(__file__).resolve().parent.parent
# What is first waits most: for processes that hang and are killed, for a browser, for servers.
FIRST = [ROOT / "tests" / folder for folder in ("faults", "end_to_end", "backend")]


@pytest.hookimpl(wrapper=True, optionalhook=True)
def pytest_xdist_auto_num_workers() -> Generator[None, int, int]:
    """One worker more than there are processors: one of them mostly waits."""
    return (yield) + 1


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what waits, so that at the end nobody waits for it: what only computes fills the gaps."""
    items.sort(key=lambda item: [folder not in item.path.parents for folder in FIRST])


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of public recordings, beside the checkout unless FIRETHREAD_SHARED_DATA says where."""
    folder = Path(os.environ.get("FIRETHREAD_SHARED_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        missing(f"the data folder {folder}", "put it there or set FIRETHREAD_SHARED_DATA")
    return folder


@pytest.fixture(scope="session")
def running_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """One server for all modules: its three processes take seconds of a processor to begin."""
    with running(tmp_path_factory.mktemp("server") / "data") as server:
        yield server


@pytest.fixture(scope="module")
def server(running_server: Server) -> Server:
    """A server at work that the tests of a module share, each with incidents of its own.

    Earlier modules have left closed incidents there, and none that is active.
    """
    server = running_server.until_it_computes()
    close_all(server)
    return server


@pytest.fixture(scope="module")
def post(server: Server) -> Iterator[Post]:
    """The command post or gateway that speaks to the shared server."""
    post = Post(server.url)
    yield post
    post.http.close()


@pytest.fixture
def postgres_url() -> Iterator[str]:
    """The URL of an empty Postgres database, dropped afterwards."""
    server = os.environ.get("FIRETHREAD_TEST_POSTGRES", "postgresql+psycopg://127.0.0.1:5432/postgres")
    admin = sa.create_engine(server, isolation_level="AUTOCOMMIT")
    name = f"firethread_test_{uuid4().hex[:12]}"
    try:
        with admin.connect() as connection:
            connection.execute(sa.text(f"CREATE DATABASE {name}"))
    except sa.exc.OperationalError as error:
        missing(f"Postgres at {server}", f"start it or set FIRETHREAD_TEST_POSTGRES ({error})")
    yield sa.engine.make_url(server).set(database=name).render_as_string(hide_password=False)
    with admin.connect() as connection:
        connection.execute(sa.text(f"DROP DATABASE {name} WITH (FORCE)"))
    admin.dispose()


@pytest.fixture(params=["sqlite", "postgres"])
def database_url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The URL of an empty database, once SQLite and once Postgres."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'firethread.db'}"
    url: str = request.getfixturevalue("postgres_url")
    return url
