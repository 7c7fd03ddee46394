"""Incidents and records for tests of what is shown."""

from collections.abc import Callable

import pytest

from backend.log.incident import Incident, IncidentSettings, Level


@pytest.fixture
def incident() -> Callable[..., Incident]:
    """Makes an incident with two storeys."""

    def make(**fields: object) -> Incident:
        levels = [Level(level=0, name="G", up_m=0.0), Level(level=1, name="first", up_m=3.0)]
        known: dict[str, object] = {
            "id": "i1",
            "name": "warehouse",
            "clock": "live",
            "state": "active",
            "origin": None,
            "levels": levels,
            "settings": IncidentSettings(),
            "created": 0.0,
            "closed": None,
            "last_seq": 0,
            "first_t": None,
            "earliest_t": None,
            "last_t": None,
        }
        known |= fields
        told = {name: known[name] for name in ("origin", "levels", "settings")}
        opened = {"after_seq": 0, "since": 0.0, **told}
        return Incident.model_validate({"stretches": [opened]} | known)

    return make
