import pytest
import sqlalchemy as sa

from backend.errors import Conflict, NotFound
from backend.log.append import append_group
from backend.log.incident import IncidentSettings, Level, Origin
from backend.log.incidents import IncidentStore, new_incident_id
from backend.log.read import SqlLogReader
from tests.backend.log.batches import MakeBatch


def test_an_incident_is_read_as_it_was_created(store: IncidentStore) -> None:
    origin = Origin(lat=59.3293, lon=18.0686, hae=28.123456789)
    levels = [Level(level=-1, name="K", up_m=-3.0), Level(level=0, name="Erdgeschoß", up_m=0.0)]
    created = store.create("Brand – Haus 3", "live", origin, levels, IncidentSettings(lag_s=30.0))
    assert store.get(created.id) == created
    assert created.state == "active"
    assert created.last_seq == 0
    assert created.closed is None


def test_incidents_are_listed_by_state_oldest_first(store: IncidentStore) -> None:
    ids = [store.create(name, "live").id for name in ("a", "b", "c")]
    store.change(ids[1], {"state": "closed"})
    assert [one.id for one in store.all()] == ids
    assert [one.id for one in store.all("active")] == [ids[0], ids[2]]
    assert [one.id for one in store.all("closed")] == [ids[1]]


@pytest.mark.parametrize("name", ["nowhere", "", "\x00", "i\x00", "é"])
def test_an_unknown_incident_is_not_found(store: IncidentStore, name: str) -> None:
    with pytest.raises(NotFound):
        store.get(name)
    with pytest.raises(NotFound):
        store.change(name, {})


def test_a_change_leaves_the_rest_as_it_was(store: IncidentStore, incident: str) -> None:
    store.change(incident, {"settings": {"lag_s": 5.0}})
    changed = store.change(incident, {"settings": {"lost_after_s": 90.0}, "name": "new"})
    assert changed.settings == IncidentSettings(lag_s=5.0, lost_after_s=90.0)
    assert changed.name == "new"
    assert store.change(incident, {}) == changed


def test_closing_is_for_good(store: IncidentStore, incident: str) -> None:
    closed = store.change(incident, {"state": "closed"})
    assert closed.closed is not None
    assert store.change(incident, {"state": "closed", "name": "x"}).closed == closed.closed
    with pytest.raises(Conflict, match="new incident"):
        store.change(incident, {"state": "active"})


def test_identifiers_sort_by_time_and_differ() -> None:
    ids = [new_incident_id(now) for now in (0.0, 1_763_712_345.0, 1_763_712_346.9, 4_102_444_800.0)]
    assert ids == sorted(ids)
    assert {len(one) for one in ids} == {13}
    # Of a thousand in one second two would be alike once in 500 runs.
    assert len({new_incident_id(5.0) for _ in range(20)}) == 20


def test_what_is_set_is_kept_with_when_and_after_which_entry(
    store: IncidentStore, incident: str, engine: sa.Engine, batch: MakeBatch
) -> None:
    opened = store.get(incident).stretches
    append_group(engine, [batch("b1"), batch("b2")])
    storeys = [Level(level=0, name="G", up_m=0.0)]
    store.change(incident, {"levels": [level.model_dump() for level in storeys]})
    append_group(engine, [batch("b3")])
    changed = store.change(incident, {"settings": {"tracker": "paper-a"}, "since": 4e9})
    assert [one.after_seq for one in changed.stretches] == [0, 2, 3]
    assert [one.levels for one in changed.stretches] == [[], storeys, storeys]
    assert [one.settings.tracker for one in changed.stretches] == ["kirchhoff", "kirchhoff", "paper-a"]
    assert changed.stretches[:1] == opened
    assert opened[0].since < changed.stretches[1].since < changed.stretches[2].since == 4e9
    assert store.get(incident) == changed
    assert store.all() == [changed]
    assert [one.number for one in SqlLogReader(engine).stretches(incident, after=0)] == [1, 2]


def test_what_sets_nothing_new_is_no_event(store: IncidentStore, incident: str) -> None:
    opened = store.get(incident).stretches
    store.change(incident, {"name": "new", "levels": [], "origin": None, "settings": {"lag_s": 60.0}})
    assert store.change(incident, {"state": "closed"}).stretches == opened


def test_nothing_is_set_before_what_it_replaces_though_the_clock_was_put_back(
    store: IncidentStore, incident: str
) -> None:
    store.change(incident, {"settings": {"lag_s": 5.0}, "since": 4e9})
    changed = store.change(incident, {"settings": {"lag_s": 6.0}})
    assert [one.since for one in changed.stretches[1:]] == [4e9, 4e9]
