import json
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.errors import Conflict, FieldError, NotFound
from backend.log.append import append_group
from backend.log.engine import make_engine
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from tests.backend.log.batches import MakeBatch, appended, seqs

ROOT = Path(__file__).parents[3]


def test_seq_counts_up_by_one_per_incident(engine: sa.Engine, store: IncidentStore, batch: MakeBatch) -> None:
    other = store.create("other", "live").id
    group = [batch("1"), batch("1", incident=other), batch("2"), batch("2", incident=other), batch("3")]
    assert seqs(append_group(engine, group)) == [1, 1, 2, 2, 3]
    assert seqs(append_group(engine, [batch("4"), batch("3", incident=other)])) == [4, 3]
    assert store.get(batch.incident).last_seq == 4


def test_a_batch_sent_again_gets_its_first_answer(engine: sa.Engine, batch: MakeBatch) -> None:
    fault = FieldError(code="unknown_kind", message="no", index=1, field="kind")
    first = batch("again", accepted=7, rejected=(fault,))
    append_group(engine, [batch("before"), first])
    repeat = batch("again", accepted=0, body=b'{"another": "body"}')
    (answer, fresh) = appended(append_group(engine, [repeat, batch("after")]))
    assert (answer.seq, answer.accepted, answer.duplicate, answer.rejected) == (2, 7, True, (fault,))
    assert (fresh.seq, fresh.duplicate) == (3, False)
    (_, logged, _) = SqlLogReader(engine).batches(batch.incident)
    assert logged.body == first.body


def test_a_batch_twice_in_one_group_is_written_once(engine: sa.Engine, batch: MakeBatch) -> None:
    answers = appended(append_group(engine, [batch("x"), batch("x"), batch("y"), batch("x")]))
    assert [(one.seq, one.duplicate) for one in answers] == [(1, False), (1, True), (2, False), (1, True)]


def test_the_same_name_from_another_gateway_is_another_batch(engine: sa.Engine, batch: MakeBatch) -> None:
    assert seqs(append_group(engine, [batch("x", gateway="a"), batch("x", gateway="b")])) == [1, 2]


def test_repeats_are_known_after_a_restart(engine: sa.Engine, url: str, batch: MakeBatch) -> None:
    append_group(engine, [batch("x")])
    engine.dispose()
    later = make_engine(url, checkpoints=True)
    (answer,) = appended(append_group(later, [batch("x")]))
    later.dispose()
    assert (answer.seq, answer.duplicate) == (1, True)


def test_a_closed_incident_refuses_new_batches_and_answers_repeats(
    engine: sa.Engine, store: IncidentStore, batch: MakeBatch
) -> None:
    other = store.create("other", "live").id
    append_group(engine, [batch("x")])
    store.change(batch.incident, {"state": "closed"})
    group = [batch("o", incident=other), batch("y"), batch("x"), batch("o2", incident=other)]
    first, refused, repeat, last = append_group(engine, group)
    assert seqs([first, last]) == [1, 2]
    assert isinstance(refused, Conflict)
    assert appended([repeat])[0].duplicate
    assert store.get(batch.incident).last_seq == 1


def test_an_unknown_incident_does_not_refuse_the_rest_of_its_group(
    engine: sa.Engine, batch: MakeBatch
) -> None:
    unknown, known = append_group(engine, [batch("x", incident="nowhere"), batch("x")])
    assert isinstance(unknown, NotFound)
    assert seqs([known]) == [1]


def test_nothing_of_a_group_is_stored_when_the_transaction_fails(engine: sa.Engine, batch: MakeBatch) -> None:
    name_is_no_text = batch("y", gateway="\ud800", body=b"{}")
    with pytest.raises(UnicodeEncodeError):
        append_group(engine, [batch("x"), name_is_no_text])
    assert seqs(append_group(engine, [batch("z")])) == [1]


def test_threads_that_append_at_once_leave_no_gap(engine: sa.Engine, url: str, batch: MakeBatch) -> None:
    def post(who: int) -> None:
        mine = make_engine(url)
        for i in range(20):
            group = [batch(f"{i}-{k}", gateway=f"g{who}") for k in range(3)] + [batch(f"shared-{i}")]
            append_group(mine, group)
        mine.dispose()

    threads = [threading.Thread(target=post, args=(who,)) for who in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    logged = list(SqlLogReader(engine).batches(batch.incident))
    assert [one.seq for one in logged] == list(range(1, 4 * 20 * 3 + 20 + 1))
    assert len({(one.gateway, one.batch) for one in logged}) == len(logged)


def test_what_another_writer_has_after_a_repeat_was_met_is_a_repeat_too(
    engine: sa.Engine, url: str, batch: MakeBatch
) -> None:
    append_group(engine, [batch("old")])
    other = make_engine(url)
    writes = threading.Thread(target=append_group, args=(other, [batch("new")]))

    @sa.event.listens_for(engine, "after_cursor_execute")
    def at_once(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        if statement.startswith("WITH asked"):  # it is known by now what had been there
            writes.start()
            writes.join(1.0)

    answers = append_group(engine, [batch("old"), batch("new"), batch("third")])
    writes.join()
    other.dispose()
    logged = list(SqlLogReader(engine).batches(batch.incident))
    assert seqs(answers) == [1, 2, 3]
    assert [one.batch for one in logged] == ["old", "new", "third"]


WRITER = """
import json, sys
from backend.log.append import append_group
from backend.log.base import NewBatch
from backend.log.engine import make_engine
url, incident, gateway = sys.argv[1:]
engine = make_engine(url)
answers = []
for i in range(0, 150, 3):
    names = ((0, gateway), (1, "shared"), (2, gateway))
    group = [
        NewBatch(incident=incident, gateway=g, batch=str(i + k), received=1, sent=None, body=b"", accepted=0)
        for k, g in names
    ]
    answers += [(one.seq, one.duplicate) for one in append_group(engine, group)]
print(json.dumps(answers))
"""


def test_two_processes_that_append_at_once_leave_no_gap(
    url: str, engine: sa.Engine, batch: MakeBatch
) -> None:
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, url, batch.incident, gateway], stdout=subprocess.PIPE, cwd=ROOT
        )
        for gateway in ("one", "two")
    ]
    told = [json.loads(process.communicate(timeout=60)[0]) for process in processes]
    logged = list(SqlLogReader(engine).batches(batch.incident))
    assert [one.seq for one in logged] == list(range(1, 251))
    new = [seq for answers in told for seq, duplicate in answers if not duplicate]
    assert sorted(new) == list(range(1, 251)), "each entry is new to exactly one of the two"
