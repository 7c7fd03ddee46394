"""What the command says to who calls it wrongly: one line that names what to mend, and no traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from backend.refusals import refusing
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
        (["demo", "--url", "http://[::1"], "--url takes an address"),
        (["demo", "--url", "http://a b/"], "--url takes an address"),
        (["demo", "--url", "http://127.0.0.1:80000"], "--url takes an address"),
        (["demo", "--scenario", "picnic"], "--scenario is one of"),
        (["serve", "--port", "0", "--data", "/dev/null"], "--data /dev/null cannot be used"),
        (["import", "none.ndjson", "--incident", "Drill"], "none.ndjson cannot be used: No such file"),
        (["import", "/dev/null", "--data", "/dev/null/here"], "--data /dev/null/here cannot be used"),
        (["import", "/dev/null", "--level", "ground"], "a level is LEVEL:NAME:UP_M"),
        (["convert", "plaza9", "."], "no data set 'plaza9'"),
        (["convert", "plaza1", "."], "groundtruth.csv is missing"),
        (["bench", "speed", "--only", "tea"], "no table 'tea'"),
    ],
)
def test_what_cannot_work_is_refused_in_a_line(words: list[str], said: str, tmp_path: Path) -> None:
    assert_refused(words, said, tmp_path)


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("lag_s=x", "settings.lag_s: Input should be a valid number"),
        ("lost_after_s=1", "settings: a node cannot be lost before it is stale"),
    ],
)
def test_a_setting_that_cannot_be_is_refused_by_its_name(setting: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "log.ndjson").write_bytes(b'{"gateway":"g","batch":"1","readings":[]}\n')
    assert_refused(["import", "log.ndjson", "--incident", "Drill", "--setting", setting], said, tmp_path)


def test_a_file_that_is_cut_off_is_refused_by_its_line(tmp_path: Path) -> None:
    (tmp_path / "log.ndjson").write_bytes(b'{"gateway":"g","batch":"1","rea')
    line = assert_refused(["import", "log.ndjson", "--incident", "Drill"], "log.ndjson, line 1: ", tmp_path)
    assert line.endswith("Input data was truncated. Nothing was imported.")


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


@pytest.mark.parametrize("defect", [KeyError("ff1"), ValueError("no"), OSError("no"), TypeError("no")])
def test_a_defect_of_ours_keeps_its_traceback(defect: Exception) -> None:
    with pytest.raises(type(defect)), refusing():
        raise defect


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
