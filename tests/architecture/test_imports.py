"""Imports run one way."""

import ast
import sys
from pathlib import Path

from importlinter.cli import EXIT_STATUS_SUCCESS, lint_imports

ROOT = Path(__file__).resolve().parents[2]
ALLOWED_IN_THE_ESTIMATOR = {"estimator", "numpy", "scipy", "numba", "msgspec"}
REACHING = {
    *("asyncio", "datetime", "io", "logging", "os", "pathlib", "random"),
    *("secrets", "socket", "subprocess", "threading", "time", "uuid"),
}


def test_the_layers_hold() -> None:
    assert lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True) == EXIT_STATUS_SUCCESS


def test_the_estimator_needs_nothing_but_numerics() -> None:
    foreign = {
        (str(path.relative_to(ROOT)), name)
        for path in (ROOT / "estimator").rglob("*.py")
        for name in imported(path)
        if name not in ALLOWED_IN_THE_ESTIMATOR and name not in sys.stdlib_module_names
    }
    assert foreign == set()


def test_the_estimator_has_no_input_or_output_and_no_clock() -> None:
    """A deterministic function of its input cannot reach for files, sockets, time or chance of its own."""
    found = {
        (str(path.relative_to(ROOT)), name)
        for path in (ROOT / "estimator").rglob("*.py")
        for name in imported(path)
        if name in REACHING
    }
    assert found == set()


def imported(path: Path) -> set[str]:
    """Top-level names that a module imports."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            names.add(node.module.split(".")[0])
    return names
