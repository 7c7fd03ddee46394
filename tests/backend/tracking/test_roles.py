"""Who draws trails asks for the tracks of what moves alone."""

import httpx2
import pytest

from tests.running import Post, eventually

START_T = 1_763_712_000.0


@pytest.fixture(scope="module")
def two_and_a_base(post: Post) -> str:
    """An incident with a base and two responders at known places."""
    incident = post.open_incident("by role")
    readings = [
        {"kind": "node", "t": START_T + second, "node": node, "role": role, "position_m": [5 * place, 0, 0]}
        for second in range(3)
        for place, (node, role) in enumerate([("base", "base"), ("ff1", "responder"), ("ff2", "responder")])
    ]
    post.telemetry(incident, "b0", readings)
    post.frame(incident, min_seq=1)
    # While the process for sums starts, 504 says to ask again.
    eventually(lambda: smoothed(post, incident).status_code == 200, within_s=60.0)
    return incident


def smoothed(post: Post, incident: str) -> httpx2.Response:
    """The smoothed tracks."""
    return post.http.get(f"/incidents/{incident}/tracks", params={"view": "smoothed"})


@pytest.mark.parametrize("view", ["live", "smoothed"])
@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ({}, {"base", "ff1", "ff2"}),
        ({"role": ["responder", "uav"]}, {"ff1", "ff2"}),
        ({"role": "base"}, {"base"}),
        ({"role": "responder", "node": "ff2"}, {"ff2"}),
        ({"role": "base", "node": "ff2"}, set()),
    ],
)
def test_tracks_are_those_of_the_roles_that_are_asked_for(
    post: Post, two_and_a_base: str, view: str, asked: dict[str, str | list[str]], found: set[str]
) -> None:
    answer = post.http.get(f"/incidents/{two_and_a_base}/tracks", params={"view": view, **asked})
    assert answer.status_code == 200
    assert {track["node"] for track in answer.json()["tracks"]} == found


def test_a_role_that_there_is_not_is_refused(post: Post, two_and_a_base: str) -> None:
    answer = post.http.get(f"/incidents/{two_and_a_base}/tracks", params={"role": "bystander"})
    assert answer.status_code == 422
