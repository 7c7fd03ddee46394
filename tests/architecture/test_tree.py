"""What the tree promises its readers."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LONGEST_FILE = 300
SCREEN_LINES, SCREEN_CHARACTERS = 50, 120
DECISIONS = ROOT / "docs" / "decisions"
CODE = {".py", ".ts", ".svelte", ".css"}
GENERATED = {"frontend/src/sources/schema.d.ts"}
BINARY = {".png", ".woff2"}


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


def test_a_decision_has_one_screen() -> None:
    too_long = [
        path.name
        for path in DECISIONS.glob("*.md")
        if len(lines := path.read_text().splitlines()) > SCREEN_LINES
        or max(map(len, lines)) > SCREEN_CHARACTERS
    ]
    assert too_long == []


def test_every_decision_that_is_named_exists_once() -> None:
    numbers = [path.name[:4] for path in DECISIONS.iterdir()]
    assert len(set(numbers)) == len(numbers)
    unknown = {
        (str(path.relative_to(ROOT)), number)
        for path in tracked()
        if path.suffix not in BINARY
        for number in decisions_named(path)
        if number not in numbers
    }
    assert unknown == set()


def decisions_named(path: Path) -> set[str]:
    """Numbers of decisions in a text: those that the word precedes; in decisions, also those in tables."""
    text = path.read_text(errors="ignore")
    named = re.findall(r"\bdecisions?[\s#/*]+(\d{4}(?:(?:,|\s|and|or)+\d{4})*)", text, re.IGNORECASE)
    numbers = {number for some in named for number in re.findall(r"\d{4}", some)}
    if path.parent == DECISIONS:
        numbers |= set(re.findall(r"\| (0\d{3}) \|", text))
    return numbers


@pytest.mark.parametrize("name", ["../README.md", "architecture.md", "glossary.md", "decisions"])
def test_files_and_names_that_documents_point_to_exist(name: str) -> None:
    """A reader who looks for `fusion/tick.py` or `physics.WALL_M` finds it."""
    files = [path for path in tracked() if path.suffix in CODE]
    place = ROOT / "docs" / name
    lost = set()
    for document in [place] if place.is_file() else place.glob("*.md"):
        text = document.read_text()
        for file in re.findall(r"`([\w/.-]+\.(?:py|ts|svelte))\b", text):
            if not any(str(path).endswith(f"/{file}") for path in files):
                lost.add((document.name, file))
        for module, meant in re.findall(r"`([a-z_][\w/]*)\.([A-Za-z_]\w*)`", text):
            homes = [path for path in files if str(path).endswith(f"/{module}.py")]
            if meant not in {"py", "ts"} and not any(defines(path, meant) for path in homes):
                lost.add((document.name, f"{module}.{meant}"))
    assert lost == set()


def test_documents_that_code_points_to_exist() -> None:
    documents = {path.name for path in tracked() if path.suffix == ".md"}
    lost = {
        (str(path.relative_to(ROOT)), named)
        for path in tracked()
        if path.suffix in CODE
        for named in re.findall(r"\b([\w-]+\.md)\b", path.read_text())
        if named not in documents
    }
    assert lost == set()


def defines(path: Path, name: str) -> bool:
    """Whether a module defines a function, a class or a constant."""
    defined = rf"^(?:def {name}\b|class {name}\b|(?:\w+, )*{name}\b[^=\n(]*=)"
    return bool(re.search(defined, path.read_text(), re.MULTILINE))


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
        if path.suffix not in BINARY and parent in path.read_text(errors="ignore")
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
