import msgspec

from backend.ingest.openapi import PATH, openapi_operation, openapi_schemas
from estimator.measurements import AnyReading


def references(value: object) -> set[str]:
    if isinstance(value, dict):
        own = {value["$ref"]} if isinstance(value.get("$ref"), str) else set()
        return own.union(*(references(inner) for inner in value.values()))
    if isinstance(value, list):
        return set().union(*(references(inner) for inner in value))
    return set()


def test_every_schema_that_is_named_is_there() -> None:
    schemas = openapi_schemas()
    named = references([openapi_operation(), schemas]) - {"#/components/schemas/Problem"}
    assert {name.removeprefix("#/components/schemas/") for name in named} <= set(schemas)


def test_every_kind_of_reading_is_described() -> None:
    schemas = openapi_schemas()
    kinds = {
        schema["properties"]["kind"]["enum"][0]
        for schema in schemas.values()
        if "kind" in schema.get("properties", {})
    }
    tags = {kind.__struct_config__.tag for kind in AnyReading.__args__}
    assert kinds == tags


def test_the_answer_and_every_refusal_are_described() -> None:
    operation = openapi_operation()
    assert PATH == "/api/v1/incidents/{incident}/telemetry"
    assert set(operation["responses"]) == {"202", "400", "401", "404", "409", "413", "415", "429", "503"}
    assert set(openapi_schemas()["BatchAnswer"]["required"]) == {
        "batch",
        "seq",
        "accepted",
        "duplicate",
        "rejected",
    }
    msgspec.json.encode(operation)
