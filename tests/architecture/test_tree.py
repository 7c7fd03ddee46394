"""What the tree promises its readers."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LONGEST_FILE = 300
CODE = {".py", ".ts", ".svelte", ".css"}
GENERATED = {"frontend/src/sources/schema.d.ts"}


def tracked() -> list[Path]:
    """The files of the project: those that git tracks, and new ones that it does not ignore."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],  # noqa: S607 - whichever git there is
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    return [ROOT / line for line in listed.stdout.splitlines() if (ROOT / line).is_file()]


def test_no_code_file_is_longer_than_a_reader_can_hold() -> None:
    too_long = {
        str(path.relative_to(ROOT)): lines
        for path in tracked()
        if path.suffix in CODE and str(path.relative_to(ROOT)) not in GENERATED
        if (lines := len(path.read_text().splitlines())) > LONGEST_FILE
    }
    assert too_long == {}


@pytest.mark.parametrize("name", ["requirements.txt", "requirements-dev.txt", "frontend/package-lock.json"])
def test_locks_hash_everything_and_name_no_registry(name: str) -> None:
    text = (ROOT / name).read_text()
    assert not re.search(
        r'"resolved"|--(extra-)?index-url|--find-links|https?://[^"\s]*\.(whl|tgz|tar\.gz)', text
    )
    if name.endswith(".txt"):
        pins = re.findall(r"^[a-z0-9][^\s;=]*==", text, re.MULTILINE)
        blocks = re.split(r"^(?=[a-z0-9])", text, flags=re.MULTILINE)[1:]
        assert len(pins) == len(blocks) > 0
        assert all("--hash=sha256:" in block for block in blocks)


def test_no_path_of_a_developers_machine_is_in_the_tree() -> None:
    parent = str(ROOT.parent) + "/"
    holders = [
        str(path.relative_to(ROOT))
        for path in tracked()
        if path.suffix not in {".png", ".woff2"} and parent in path.read_text(errors="ignore")
    ]
    assert holders == []


def test_tests_stand_where_their_source_stands() -> None:
    """A newcomer finds the test of `backend/log/append.py` under `tests/backend/log`."""
    homeless = [
        str(path.relative_to(ROOT))
        for top in ("backend", "estimator")
        for path in (ROOT / "tests" / top).rglob("test_*.py")
        if not (ROOT / path.parent.relative_to(ROOT / "tests")).is_dir()
    ]
    assert homeless == []
