"""Parameters that a route does not know, or not twice, on a real server."""

import pytest

from tests.backend.refusing import assert_refused
from tests.running import Post, Server


@pytest.mark.parametrize(
    ("path", "named", "takes"),
    [
        ("advice?node=ff1&t=5", "query.t", "`node`"),
        ("tracks?start=5", "query.start", "`from`"),
        ("relative?a=ff1&b=ff2&token=x", "query.token", "`a`, `b`"),
    ],
)
def test_a_question_with_an_unknown_parameter_is_refused_and_told_which_there_are(
    post: Post, path: str, named: str, takes: str
) -> None:
    answer = post.http.get(f"/incidents/{post.open_incident()}/{path}")
    assert answer.status_code == 422
    (fault,) = answer.json()["errors"]
    assert (fault["code"], fault["field"]) == ("unknown_parameter", named)
    assert takes in fault["message"]


@pytest.mark.parametrize(
    "path", ["evidence?node=ff1&node=ff2", "frame?t=5&t=6", "tracks?role=uav&node=a&node=b"]
)
def test_a_question_that_names_one_thing_twice_is_refused_rather_than_answered_for_the_last(
    post: Post, path: str
) -> None:
    answer = post.http.get(f"/incidents/{post.open_incident()}/{path}")
    assert answer.status_code == 422
    (fault,) = answer.json()["errors"]
    assert fault["code"] == "repeated_parameter"
    assert fault["field"] in {"query.node", "query.t"}


def test_what_is_a_list_may_be_named_as_often_as_it_has_entries(post: Post) -> None:
    assert post.http.get(f"/incidents/{post.open_incident()}/tracks?role=uav&role=base").status_code == 200


def test_what_takes_no_parameters_says_so(post: Post) -> None:
    answer = post.http.get(f"/incidents/{post.open_incident()}", params={"t": 5})
    assert (answer.status_code, "takes none" in answer.json()["detail"]) == (422, True)


def test_a_socket_with_an_unknown_parameter_is_not_opened(server: Server, post: Post) -> None:
    incident = post.open_incident()
    assert_refused(server, f"/incidents/{incident}/replay?start=5", 422, "`from`")
    assert_refused(server, f"/incidents/{incident}/replay?from=5&from=6", 422, "more than once")


def test_health_is_told_whatever_a_probe_adds(post: Post, server: Server) -> None:
    assert post.http.get(f"{server.url}/healthz?probe=1").status_code == 200
