"""What the container's image promises: its first start finds compiled what takes minutes to compile."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOLD_WHERE = """
from estimator.graph.chain_kernels import eliminate
print(eliminate._cache.cache_path)
"""


def last_stage() -> list[str]:
    """Its instructions, each on one line."""
    whole = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
    lines = [line for line in whole.splitlines() if line and not line.startswith("#")]
    return lines[max(i for i, line in enumerate(lines) if line.startswith("FROM ")) :]


def test_who_runs_has_compiled_in_a_folder_of_his_own() -> None:
    lines = last_stage()
    warm = next(i for i, line in enumerate(lines) if "estimator.warm" in line)
    users = [i for i, line in enumerate(lines) if line.startswith("USER ")]
    assert len(users) == 1
    assert users[0] < warm, "whoever runs may not read what another one has compiled"
    (told,) = [i for i, line in enumerate(lines) if line.startswith("ENV NUMBA_CACHE_DIR=")]
    assert told < warm
    folder, user = lines[told].partition("=")[2], lines[users[0]].split()[1]
    owned = re.search(rf"chown {user} ([^&|;]*)", " ".join(lines[: users[0]]))
    assert owned is not None
    assert folder in owned[1].split()


def test_what_is_compiled_lies_in_the_folder_that_is_named(tmp_path: Path) -> None:
    told = subprocess.run(
        [sys.executable, "-c", TOLD_WHERE],
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
        check=True,
        capture_output=True,
        text=True,
    )
    assert Path(told.stdout.strip()).parent == tmp_path
