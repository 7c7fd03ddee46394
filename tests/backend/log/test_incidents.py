import pytest

from backend.errors import Conflict, NotFound
from backend.log.incident import IncidentSettings, Level, Origin
from backend.log.incidents import IncidentStore, new_incident_id


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
