"""`evidence` and `advice` of a real server."""

from functools import partial

import msgspec
import pytest

from estimator.evidence import Advice, Evidence
from tests.backend.tracking.conftest import walk
from tests.running import Post, eventually, quickest_s

START_T = 1_000.0
SECONDS = 12


@pytest.fixture(scope="module")
def walked(post: Post) -> str:
    """An incident in which two responders walked, and a third has only been heard of."""
    incident = post.open_incident("a walk")
    for number, readings in enumerate(walk(SECONDS, START_T)):
        post.telemetry(incident, f"b{number}", msgspec.to_builtins(readings))
    last_t = START_T + SECONDS
    post.telemetry(incident, "heard-of", [{"kind": "node", "t": last_t, "node": "ff3", "role": "responder"}])
    return incident


def get(post: Post, incident: str, what: str, **parameters: object) -> tuple[int, bytes]:
    response = post.http.get(f"/incidents/{incident}/{what}", params=parameters or None)  # type: ignore[arg-type]  # plain values
    return response.status_code, response.content


def evidence(post: Post, incident: str, **parameters: object) -> Evidence:
    status, body = get(post, incident, "evidence", **parameters)
    assert status == 200, body
    return msgspec.json.decode(body, type=Evidence)


def test_the_evidence_names_the_measurements_that_hold_the_fix(post: Post, walked: str) -> None:
    found = evidence(post, walked, node="ff1")
    assert found.node == "ff1"
    assert START_T + SECONDS - 1.0 <= found.t <= START_T + SECONDS + 0.2
    assert found.held
    shares = [measurement.share for measurement in found.held]
    assert shares == sorted(shares, reverse=True)
    assert sum(shares) + found.rest == pytest.approx(1.0, abs=1e-6)


def test_of_a_moment_only_what_tells_of_epochs_up_to_it_counts(post: Post, walked: str) -> None:
    t = START_T + 5.0
    found = evidence(post, walked, node="ff1", t=t)
    assert t - 1.0 <= found.t <= t
    assert found.held
    assert all(measurement.t <= t for measurement in found.held + found.rejected)


def test_an_entry_that_came_later_but_tells_of_an_earlier_epoch_counts(post: Post) -> None:
    incident = post.open_incident("a late word")
    fix = {"kind": "position", "node": "ff1", "position_m": [0, 0, 0], "sigma_m": [2, 2, 2]}
    post.telemetry(incident, "b1", [fix | {"t": 10.0}])
    before = evidence(post, incident, node="ff1", t=11.0)
    post.telemetry(incident, "b2", [fix | {"t": 20.0}])
    assert evidence(post, incident, node="ff1", t=11.0) == before
    post.telemetry(incident, "b3", [fix | {"t": 10.5}])
    after = evidence(post, incident, node="ff1", t=11.0)
    assert after.covariance_m2[0] < before.covariance_m2[0]


def test_of_a_moment_the_origin_of_then_counts(post: Post) -> None:
    there, here = ({"lat": 50.0, "lon": 14.0 + east, "hae": 200.0} for east in (0.0, 0.001))
    incident = post.open_incident("moved", origin=there)
    fix = {"kind": "position", "node": "ff1", "wgs84": [50.0, 14.0, 200.0], "sigma_m": [2, 2, 2]}
    for number in range(3):
        post.telemetry(incident, f"b{number}", [fix | {"t": 10.0 + number}])
    post.frame(incident, min_seq=3)
    assert post.http.patch(f"/incidents/{incident}", json={"origin": here}).status_code == 200
    for number in range(3, 6):
        post.telemetry(incident, f"b{number}", [fix | {"t": 10.0 + number}])
    eventually(lambda: get(post, incident, "frame", t=14.0)[1] != get(post, incident, "frame", t=11.0)[1])
    assert evidence(post, incident, node="ff1", t=11.0).position_m[0] == pytest.approx(0.0, abs=1.0)
    assert evidence(post, incident, node="ff1").position_m[0] == pytest.approx(-71.7, abs=1.0)


def test_asking_again_costs_nothing(post: Post, walked: str) -> None:
    for what in ("evidence", "advice"):
        first = get(post, walked, what, node="ff2")
        assert get(post, walked, what, node="ff2") == first
        assert quickest_s(partial(get, post, walked, what, node="ff2")) < 0.5


def test_the_advice_names_what_would_help(post: Post, walked: str) -> None:
    status, body = get(post, walked, "advice", node="ff1")
    assert status == 200, body
    found = msgspec.json.decode(body, type=Advice)
    assert found.node == "ff1"
    assert found.suggestions
    assert found.suggestions[0].sigma_m < found.sigma_m


@pytest.mark.parametrize("what", ["evidence", "advice"])
def test_a_node_without_a_position_is_told_as_such(post: Post, walked: str, what: str) -> None:
    status, body = get(post, walked, what, node="ff3")
    assert status == 409
    assert "not decided" in msgspec.json.decode(body)["detail"]


@pytest.mark.parametrize("what", ["evidence", "advice"])
def test_of_the_base_it_is_said_that_nothing_measured_holds_it(post: Post, walked: str, what: str) -> None:
    status, body = get(post, walked, what, node="base")
    assert status == 409
    detail = msgspec.json.decode(body)["detail"]
    assert "'base' is a base" in detail
    assert "not decided" not in detail


def test_an_anchor_is_held_by_what_was_told_of_it_though_nobody_moves(post: Post) -> None:
    incident = post.open_incident("still")
    anchor = {"kind": "node", "node": "a1", "role": "anchor", "position_m": [5, 5, 0], "sigma_m": 0.3}
    ack = post.telemetry(incident, "b1", [anchor | {"t": START_T}])
    post.frame(incident, min_seq=int(str(ack["seq"])))
    found = evidence(post, incident, node="a1")
    assert [(one.kind, one.a) for one in found.held] == [("prior", "a1")]
    assert found.position_m == pytest.approx((5.0, 5.0, 0.0))


@pytest.mark.parametrize(
    ("what", "parameters"),
    [
        ("evidence", {"node": "nobody"}),
        ("evidence", {"node": "ff1", "t": START_T - 1.0}),
        ("advice", {"node": "nobody"}),
    ],
)
def test_a_node_that_was_never_named_is_told_as_such(
    post: Post, walked: str, what: str, parameters: dict[str, object]
) -> None:
    status, body = get(post, walked, what, **parameters)
    assert status == 404
    assert str(parameters["node"]) in msgspec.json.decode(body)["detail"]


@pytest.mark.parametrize("what", ["evidence", "advice"])
def test_an_unknown_or_silent_incident_is_told_as_such(post: Post, what: str) -> None:
    assert get(post, "nobody", what, node="ff1")[0] == 404
    assert get(post, post.open_incident("silent"), what, node="ff1")[0] == 404


@pytest.mark.parametrize(
    ("what", "parameters"),
    [
        ("evidence", {}),
        ("evidence", {"node": ""}),
        ("evidence", {"node": "x" * 65}),
        ("evidence", {"node": "ff1", "t": "NaN"}),
        ("evidence", {"node": "ff1", "t": -1}),
        ("advice", {}),
        ("advice", {"node": ""}),
    ],
)
def test_parameters_outside_their_bounds_are_refused(
    post: Post, walked: str, what: str, parameters: dict[str, object]
) -> None:
    status, body = get(post, walked, what, **parameters)
    assert status == 422
    assert msgspec.json.decode(body)["errors"]
