"""The whole API under generated requests: no defect, and every refusal in the contract's form."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hypothesis
import pytest
import schemathesis
from schemathesis.specs.openapi.checks import negative_data_rejection, positive_data_acceptance

from backend.errors import PROBLEM_MEDIA_TYPE
from tests.running import ANSWERED_WITHIN_S, Post, Server, running

# `make check` holds this file against the application's own document.
DOCUMENT = Path(__file__).parents[2] / "frontend" / "openapi.json"
schema = schemathesis.openapi.from_path(DOCUMENT)

# JSON Schema cannot say that two fields must agree; and a batch with bad readings is taken, by contract.
BEYOND_A_SCHEMA = (negative_data_rejection, positive_data_acceptance)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server of its own: whoever came after would find what generated requests have made of it."""
    with running(tmp_path_factory.mktemp("fire") / "data") as server:
        yield server.until_it_computes()


@pytest.fixture(scope="module")
def incident(server: Server) -> str:
    """An incident that generated requests are aimed at: an invented one would only ever be unknown."""
    return Post(server.url).open_incident("under fire")


@schema.parametrize()
@hypothesis.settings(max_examples=40, deadline=None)
def test_no_request_is_a_defect(case: schemathesis.Case[Any], server: Server, incident: str) -> None:
    if "incident" in case.path_parameters and case.method != "PATCH":
        case.path_parameters["incident"] = incident
    if case.path.endswith("/frame"):
        case.query["min_seq"] = 0  # an entry that never comes is answered 504, by contract
    response = case.call_and_validate(
        base_url=server.url, excluded_checks=list(BEYOND_A_SCHEMA), timeout=ANSWERED_WITHIN_S
    )
    if response.status_code >= 400:
        assert response.headers["content-type"][0].startswith(PROBLEM_MEDIA_TYPE)
