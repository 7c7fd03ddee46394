"""Routes that create, list, show and change incidents."""

from typing import Annotated

from fastapi import APIRouter, Query, Response
from pydantic import ValidationError

from backend.errors import Invalid
from backend.incidents.models import IncidentChange, NewIncident
from backend.log.incident import Incident, State
from backend.log.incidents import IncidentStore


def incidents_router(store: IncidentStore) -> APIRouter:
    """The routes, on incidents in `store`."""
    router = APIRouter(prefix="/api/v1/incidents", tags=["incidents"])

    @router.post("", status_code=201, operation_id="create_incident", summary="Create an incident")
    def create_incident(new: NewIncident, response: Response) -> Incident:
        incident = store.create(new.name, new.clock, new.origin, new.levels, new.settings)
        response.headers["location"] = f"/api/v1/incidents/{incident.id}"
        return incident

    @router.get("", operation_id="list_incidents", summary="List incidents, oldest first")
    def list_incidents(
        state: Annotated[State | None, Query(description="only those in this state")] = None,
    ) -> list[Incident]:
        return store.all(state)

    @router.get("/{incident}", operation_id="get_incident", summary="Show an incident")
    def get_incident(incident: str) -> Incident:
        return store.get(incident)

    @router.patch("/{incident}", operation_id="change_incident", summary="Change or close an incident")
    def change_incident(incident: str, change: IncidentChange) -> Incident:
        try:
            return store.change(incident, change.model_dump(exclude_unset=True))
        except ValidationError as error:
            raise Invalid.by_field(error.errors(), ("body", "settings")) from error

    return router
