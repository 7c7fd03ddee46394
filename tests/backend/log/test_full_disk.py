"""A disk that runs full, for real: a file system of four megabytes."""

import asyncio
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from backend.log.base import LogUnwritable
from backend.log.engine import make_engine
from backend.log.group_commit import GroupCommit
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader
from tests.backend.log.batches import MakeBatch
from tests.needs import missing

DISK_BYTES = 4 * 1024 * 1024
BODY = b"x" * 20_000


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    folder = tmp_path / "disk"
    folder.mkdir()
    command = ["/bin/mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", str(folder)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        missing("the command /bin/mount", f"install util-linux ({error})")
    if done.returncode:
        missing("the right to mount a small tmpfs", f"run as root ({done.stderr.strip()})")
    yield folder
    subprocess.run(["/bin/umount", "--lazy", str(folder)], check=True)


def test_a_full_disk_loses_nothing_acknowledged_and_needs_no_restart(small_disk: Path) -> None:
    url = f"sqlite:///{small_disk / 'firethread.db'}"
    prepare(url)
    engine = make_engine(url)
    batch = MakeBatch(IncidentStore(engine).create("fire", "live").id)
    reader = SqlLogReader(engine)
    ballast = small_disk / "ballast"
    ballast.write_bytes(b"-" * (DISK_BYTES // 4))

    def names() -> list[str]:
        return [one.batch for one in reader.batches(batch.incident)]

    async def post() -> None:
        writer = GroupCommit(url, 64 * 1024 * 1024)
        await writer.start()
        acknowledged: list[str] = []
        refused: list[LogUnwritable] = []
        for i in range(400):
            try:
                await writer.append(batch(f"b{i}", body=BODY))
                acknowledged.append(f"b{i}")
            except LogUnwritable as problem:
                refused.append(problem)
                if len(refused) == 20:
                    break
        assert len(refused) == 20, "the disk was to run full"
        assert all(problem.status == 503 and problem.retry_after_s for problem in refused)
        assert len(acknowledged) > 20
        assert names() == acknowledged

        told = [writer.refusal is not None]
        ballast.unlink()
        answer = await writer.append(batch("after", body=BODY))
        told.append(writer.refusal is not None)
        assert told == [True, False]
        assert answer.seq == len(acknowledged) + 1
        assert names() == [*acknowledged, "after"]
        again = await writer.append(batch("b0", body=BODY))
        assert (again.seq, again.duplicate) == (1, True)
        await writer.close()

    asyncio.run(post())
    engine.dispose()
