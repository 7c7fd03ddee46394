"""What the command says to who calls it wrongly: one line that names what to mend, and no traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from backend.settings import LINK_TOKEN_VARIABLE

NO_DATABASE = "postgresql://127.0.0.1:1/nowhere"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["serve", "--port", "0", "--database", "a database"], "--database takes a URL"),
        (["serve", "--port", "0", "--database", NO_DATABASE], "--database"),
        (["serve", "--port", "0", "--link", "[::1]"], "--link takes HOST:PORT"),
        (["worker", "--database", "a database"], "--database takes a URL"),
        (["worker", "--database", "postgresql://host:port/name"], "--database takes a URL"),
        (["worker", "--database", "mysql://host/name"], "not in 'mysql'"),
        (["worker", "--database", "postgresql+asyncpg://host/name"], "not in 'postgresql+asyncpg'"),
        (["worker", "--link", "web"], "--link takes HOST:PORT"),
        (["worker", "--link", "web:"], "--link takes HOST:PORT"),
        (["worker", "--link", "web:70700"], "--link takes HOST:PORT"),
        (["export", "Drill", "--database", NO_DATABASE], "--database"),
        (["demo", "--url", "127.0.0.1:8000"], "--url takes an address"),
    ],
)
def test_what_cannot_work_is_refused_in_a_line(words: list[str], said: str, tmp_path: Path) -> None:
    assert_refused(words, said, tmp_path)


def test_a_password_is_not_repeated(tmp_path: Path) -> None:
    for database in (
        "postgresql://me:my password@host:port/name",
        "postgresql://me:my-password@127.0.0.1:1/x",
    ):
        assert "password@" not in assert_refused(
            ["serve", "--port", "0", "--database", database], "--database", tmp_path
        )


def test_the_demo_takes_a_token_and_makes_none(tmp_path: Path) -> None:
    assert_refused(["demo", "--data", str(tmp_path)], "no access token", tmp_path)
    assert list(tmp_path.iterdir()) == []


def assert_refused(words: list[str], said: str, folder: Path) -> str:
    """The command ends at once, with one line that holds what is `said`; the line."""
    ended = subprocess.run(
        [sys.executable, "-m", "backend.cli", *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), LINK_TOKEN_VARIABLE: "shared"},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ended.returncode == 2, ended.stderr
    lines = [line for line in ended.stderr.splitlines() if "limit of open files" not in line]
    assert len(lines) == 1, ended.stderr
    assert lines[0].startswith("firethread: ")
    assert said in lines[0]
    return lines[0]
