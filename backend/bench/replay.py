"""`firethread bench replay`: how fast the log is read back, beside decoding the same bodies from memory."""

import statistics
import tempfile
import time

from backend.bench.telemetry import batch_bodies
from backend.log.append import append_group
from backend.log.base import NewBatch
from backend.log.batch import accepted_readings, decode_batch
from backend.log.engine import make_engine
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader

SIZES = (10, 100, 1_000)
TARGET = 0.65
ROUNDS = 5
READINGS = 200_000
"""In each log: some tens of megabytes."""


def run(rounds: int = ROUNDS, readings: int = READINGS) -> None:
    """Measure, and print the table.

    Args:
        rounds: how often each is measured, in turns.
        readings: in each log.
    """
    print(f"logs of {readings} readings in SQLite; median of {rounds} rounds, in turns")
    print("memory: the same bodies decoded one after the other, from memory\n")
    print("readings     memory/s    log/s  ratio    min    max  target")
    for size in SIZES:
        with tempfile.TemporaryDirectory() as folder:
            reader, incident, bodies = _logged(folder, size, readings // size)
            memory, log = [], []
            for _ in range(rounds):
                start = time.perf_counter()
                for body in bodies:
                    decode_batch(body)
                memory.append(readings / (time.perf_counter() - start))
                start = time.perf_counter()
                for logged in reader.batches(incident):
                    accepted_readings(logged)
                log.append(readings / (time.perf_counter() - start))
        ratios = [back / best for back, best in zip(log, memory, strict=True)]
        middle = statistics.median
        print(
            f"{size:>8} {middle(memory):>12.0f} {middle(log):>8.0f} {middle(ratios):>6.2f} "
            f"{min(ratios):>6.2f} {max(ratios):>6.2f} {TARGET:>7.2f}",
            flush=True,
        )


def _logged(folder: str, size: int, count: int) -> tuple[SqlLogReader, str, list[bytes]]:
    """A log of `count` batches: its reader, its incident, and the bodies in it."""
    url = f"sqlite:///{folder}/firethread.db"
    prepare(url)
    engine = make_engine(url, checkpoints=True)
    incident = IncidentStore(engine).create("bench replay", "recorded").id
    different = batch_bodies(size, time.time())
    bodies = [different[i % len(different)] for i in range(count)]
    batches = [
        NewBatch(
            incident=incident,
            gateway="bench",
            batch=str(i),
            received=time.time(),
            sent=None,
            body=body,
            accepted=size,
        )
        for i, body in enumerate(bodies)
    ]
    for start in range(0, count, 200):
        append_group(engine, batches[start : start + 200])
    return SqlLogReader(engine), incident, bodies
