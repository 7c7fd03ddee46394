"""`frame`, `relative` and `tracks` of a real server."""

import math
import time
from typing import Any

import msgspec
import pytest

from backend.log.engine import make_engine
from backend.log.read import SqlLogReader
from backend.tracking.routes import relative_position
from estimator.estimate import Relative
from tests.estimator.inertial.gait import Stride
from tests.estimator.inertial.gait import walked as boot_walked
from tests.running import Post, Server, eventually, quickest_s

START_T = 1_000.0
SECONDS = 20


@pytest.fixture(scope="module")
def walked(post: Post) -> str:
    """An incident in which two responders have walked for twenty seconds and a half."""
    incident = post.open_incident("a walk")
    post.telemetry(
        incident,
        "b0",
        [
            {"kind": "node", "t": START_T, "node": "base", "role": "base", "position_m": [0, 0, 0]},
            {"kind": "position", "t": START_T, "node": "ff1", "position_m": [0, 0, 0], "sigma_m": [1, 1, 1]},
            {"kind": "position", "t": START_T, "node": "ff2", "position_m": [0, 5, 0], "sigma_m": [1, 1, 1]},
        ],
    )
    for step in range(1, 2 * SECONDS + 2):
        t = START_T + step / 2
        post.telemetry(
            incident,
            f"b{step}",
            [
                {"kind": "displacement", "t": t, "node": node, "delta_m": [0.5, 0, 0]}
                for node in ("ff1", "ff2")
            ],
        )
    post.frame(incident, min_seq=2 * SECONDS + 2)
    return incident


def get(post: Post, incident: str, what: str, **parameters: object) -> tuple[int, dict[str, object]]:
    response = post.http.get(f"/incidents/{incident}/{what}", params=parameters or None)  # type: ignore[arg-type]  # plain values
    return response.status_code, response.json()


def test_the_frame_holds_what_was_posted_before(post: Post, walked: str) -> None:
    frame = post.frame(walked)
    nodes = {node["node"]: node for node in frame["nodes"]}  # type: ignore[attr-defined]  # JSON
    assert set(nodes) == {"base", "ff1", "ff2"}
    assert nodes["ff1"]["position_m"] == pytest.approx([20.5, 0.0, 0.0], abs=0.5)
    assert frame["t"] == frame["newest_t"] == START_T + SECONDS + 0.5
    assert frame["seq"] == 2 * SECONDS + 2


def test_a_boot_that_sends_raw_samples_is_shown_where_it_goes(post: Post) -> None:
    incident, gait = post.open_incident("a boot"), boot_walked([Stride()] * 10, start_t=START_T)
    first = {"kind": "node", "t": START_T, "node": "ff1", "role": "responder", "position_m": [0, 0, 0]}
    post.telemetry(incident, "b0", [first])
    for number, reading in enumerate(gait.readings(), 1):
        post.telemetry(incident, f"b{number}", [msgspec.to_builtins(reading)])
    frame = post.frame(incident, min_seq=len(gait.readings()) + 1)
    node: dict[str, Any] = next(iter(frame["nodes"]))  # type: ignore[call-overload]  # JSON
    assert node["position_m"] == pytest.approx(gait.place_m[-1].tolist(), abs=0.5)
    assert frame["t"] - 0.5 <= node["t"] <= frame["t"]  # type: ignore[operator]  # JSON


def test_an_entry_that_is_never_folded_is_waited_for_in_vain(post: Post, walked: str) -> None:
    began = time.monotonic()
    status, problem = get(post, walked, "frame", min_seq=10_000, timeout_s=0.3)
    assert 0.3 <= time.monotonic() - began < 3.0
    assert (status, problem["status"]) == (504, 504)
    assert "10000" in str(problem["detail"])


def test_the_frame_of_a_moment_shows_what_was_known_then(post: Post, walked: str) -> None:
    eventually(lambda: len(points(post, walked, "ff1")) >= SECONDS)
    for second in (5, 12):
        frame = post.frame(walked, t=START_T + second)
        nodes = {node["node"]: node for node in frame["nodes"]}  # type: ignore[attr-defined]  # JSON
        assert frame["t"] == START_T + second
        assert nodes["ff1"]["t"] <= START_T + second
        assert nodes["ff1"]["position_m"] == pytest.approx([float(second), 0.0, 0.0], abs=0.6)


def test_what_nothing_has_come_since_is_shown_of_each_moment_since(post: Post) -> None:
    incident = post.open_incident(clock="live")
    t = time.time()
    called = {"kind": "alarm", "t": t, "node": "ff1", "alarm": "mayday", "state": "raised"}
    post.telemetry(incident, "1", [called])
    post.frame(incident, min_seq=1)
    time.sleep(max(0.0, t + 1.1 - time.time()))
    frame = post.frame(incident, t=t + 1.0)
    assert (frame["seq"], [alarm["node"] for alarm in frame["alarms"]]) == (1, ["ff1"])  # type: ignore[attr-defined]
    assert post.frame(incident, t=t - 5.0)["alarms"] == []


def test_before_the_first_reading_nothing_was_known(post: Post, walked: str) -> None:
    assert post.frame(walked, t=1.0)["nodes"] == []


def test_a_mayday_that_its_unit_cleared_unacknowledged_is_in_the_frames_until_a_person_answers(
    post: Post,
) -> None:
    incident = post.open_incident("a mayday")
    said = {"kind": "alarm", "node": "ff1", "alarm": "mayday"}
    lunar = "Location: second floor. Name: Novak."
    for t, state, text in (
        (10.0, "raised", lunar),
        (12.0, "cleared", "switched off"),
        (15.0, "acknowledged", "RIT: E7"),
    ):
        post.telemetry(incident, state, [said | {"t": t, "state": state, "text": text}])
    post.telemetry(incident, "later", [{"kind": "status", "t": 17.0, "node": "ff1", "battery": 0.5}])
    assert post.frame(incident, min_seq=4)["alarms"] == []
    eventually(lambda: [post.frame(incident, t=t)["seq"] for t in (11.0, 14.0, 16.0)] == [1, 2, 3])
    shown = [(11.0, "raised", lunar), (14.0, "cleared", f"{lunar}\nswitched off")]
    for t, state, text in shown:
        alarms: Any = post.frame(incident, t=t)["alarms"]
        assert [(alarm["state"], alarm["t"], alarm["text"]) for alarm in alarms] == [(state, 10.0, text)]
    assert post.frame(incident, t=16.0)["alarms"] == []


def points(post: Post, incident: str, node: str, **parameters: object) -> list[list[float]]:
    status, answer = get(post, incident, "tracks", node=node, **parameters)
    assert status == 200, answer
    tracks = answer["tracks"]
    assert isinstance(tracks, list)
    return list(tracks[0]["points"]) if tracks else []


def test_a_track_has_a_point_at_each_whole_second(post: Post, walked: str) -> None:
    eventually(lambda: len(points(post, walked, "ff1")) >= SECONDS + 2)
    track = points(post, walked, "ff1")
    assert [point[0] for point in track] == [START_T + second for second in range(SECONDS + 2)]
    assert all(len(point) == 10 for point in track)
    assert [point[1] for point in track[:-1]] == pytest.approx(list(range(SECONDS + 1)), abs=0.6)


def test_a_track_may_be_cut_and_thinned(post: Post, walked: str) -> None:
    eventually(lambda: len(points(post, walked, "ff1")) >= SECONDS + 2)
    cut = points(post, walked, "ff1", **{"from": START_T + 3.5, "to": START_T + 12.5, "step": 4})
    assert [point[0] for point in cut] == [START_T + 4, START_T + 8, START_T + 12]


def test_a_point_of_a_live_track_is_what_the_frame_of_its_second_shows(post: Post, walked: str) -> None:
    for t, *place in points(post, walked, "ff2", step=5):
        nodes = {node["node"]: node for node in post.frame(walked, t=t)["nodes"]}  # type: ignore[attr-defined]  # JSON
        if t <= START_T + SECONDS:
            assert [*nodes["ff2"]["position_m"], *nodes["ff2"]["covariance_m2"]] == place


@pytest.mark.parametrize("view", ["live", "smoothed"])
def test_who_only_draws_a_track_may_have_it_in_millimetres(post: Post, walked: str, view: str) -> None:
    whole = points(post, walked, "ff1", view=view)
    rough = points(post, walked, "ff1", view=view, decimals=3)
    assert [point[0] for point in rough] == [point[0] for point in whole]
    for one, other in zip(rough, whole, strict=True):
        assert one == pytest.approx(other, abs=0.000501)
        assert all(len(repr(number).partition(".")[2]) <= 3 for number in one)
    assert rough != whole


def test_all_points_are_there_as_soon_as_their_entries_are_folded(post: Post) -> None:
    incident = post.open_incident("in a hurry")
    for t in range(100, 161):
        fix = {"kind": "position", "t": t, "node": "ff1", "position_m": [0, 0, 0], "sigma_m": [1, 1, 1]}
        post.telemetry(incident, f"b{t}", [fix])
    post.frame(incident, min_seq=61)
    assert [point[0] for point in points(post, incident, "ff1")] == [float(t) for t in range(100, 161)]
    assert post.frame(incident, t=158.5)["seq"] == 59


def test_seconds_without_news_are_filled_and_grow_less_certain(post: Post) -> None:
    incident = post.open_incident("a gap")
    for t in (10.0, 10.5, 20.5, 21.5):
        fix = {"kind": "position", "t": t, "node": "ff1", "position_m": [0, 0, 0], "sigma_m": [1, 1, 1]}
        post.telemetry(incident, f"b{t}", [fix])
    eventually(lambda: len(points(post, incident, "ff1")) >= 13)
    track = points(post, incident, "ff1")
    assert [point[0] for point in track] == [float(second) for second in range(10, 23)]
    variances = [point[4] for point in track[1:11]]
    assert variances == sorted(variances)
    assert variances[-1] > variances[0] + 10.0
    part = points(post, incident, "ff1", **{"from": 14, "to": 25})
    assert part == track[4:]
    assert points(post, incident, "ff1", **{"from": 14, "to": 18.5}) == track[4:9]


def test_the_smoothed_track_uses_everything(post: Post, walked: str) -> None:
    smoothed = points(post, walked, "ff1", view="smoothed")
    assert [point[0] for point in smoothed[:3]] == [START_T, START_T + 1, START_T + 2]
    assert smoothed[10][1:3] == pytest.approx([10.0, 0.0], abs=1.0)
    assert points(post, walked, "ff1", view="smoothed") == smoothed
    again_s = quickest_s(lambda: points(post, walked, "ff1", view="smoothed"))
    assert again_s < 1.0, "the second asking should cost nothing"


def test_the_relative_position_comes_with_its_own_uncertainty(post: Post, walked: str) -> None:
    status, answer = get(post, walked, "relative", a="ff1", b="ff2")
    assert status == 200, answer
    assert answer["delta_m"] == pytest.approx([0.0, 5.0, 0.0], abs=0.5)
    assert answer["distance_m"] == pytest.approx(5.0, abs=0.5)
    assert isinstance(answer["distance_sigma_m"], float)
    assert 0.0 < answer["distance_sigma_m"] < 5.0


def test_the_relative_position_is_told_while_the_worker_is_away_and_after_closing(
    server: Server, post: Post, walked: str
) -> None:
    expected = get(post, walked, "relative", a="ff1", b="ff2")
    engine = make_engine(f"sqlite:///{server.data / 'firethread.db'}")
    eventually(lambda: (kept := SqlLogReader(engine).snapshot(walked)) and kept.seq == 2 * SECONDS + 2)
    engine.dispose()
    server.kill_worker()
    assert get(post, walked, "relative", a="ff1", b="ff2") == expected
    assert get(post, walked, "relative", a="ff1", b="nobody")[0] == 404


@pytest.mark.parametrize(
    ("what", "parameters"),
    [
        ("frame", {"t": "NaN"}),
        ("frame", {"t": "inf"}),
        ("frame", {"t": -1}),
        ("frame", {"t": "noon"}),
        ("frame", {"min_seq": -1}),
        ("frame", {"min_seq": 10**30}),
        ("frame", {"timeout_s": 61}),
        ("frame", {"timeout_s": "nan"}),
        ("relative", {"a": "ff1"}),
        ("relative", {"a": "ff1", "b": "ff1"}),
        ("relative", {"a": "x" * 65, "b": "ff1"}),
        ("tracks", {"step": 0}),
        ("tracks", {"step": "1e400"}),
        ("tracks", {"from": "NaN"}),
        ("tracks", {"view": "guessed"}),
        ("tracks", {"node": ""}),
        ("tracks", {"from": 9, "to": 8}),
        ("tracks", {"decimals": -1}),
    ],
)
def test_parameters_outside_their_bounds_are_refused(
    post: Post, walked: str, what: str, parameters: dict[str, object]
) -> None:
    status, problem = get(post, walked, what, **parameters)
    assert status == 422, problem
    assert problem["errors"]


@pytest.mark.parametrize("view", ["live", "smoothed"])
def test_a_track_of_a_node_that_nothing_has_named_is_not_found(post: Post, walked: str, view: str) -> None:
    status, problem = get(post, walked, "tracks", node="nobody", view=view)
    assert (status, problem["detail"]) == (404, "No reading of this incident has named 'nobody'.")


def test_who_is_known_but_nowhere_has_no_track(post: Post) -> None:
    incident = post.open_incident("somewhere")
    post.telemetry(incident, "b1", [{"kind": "status", "t": 5.0, "node": "ff1", "battery": 0.5}])
    post.frame(incident, min_seq=1)
    assert get(post, incident, "tracks", node="ff1") == (200, {"tracks": []})


@pytest.mark.parametrize("what", ["frame", "tracks", "relative?a=x&b=y"])
def test_an_unknown_incident_is_told_as_such(post: Post, what: str) -> None:
    assert get(post, "nobody", what)[0] == 404


def test_an_incident_without_readings_has_an_empty_frame_and_no_tracks(post: Post) -> None:
    incident = post.open_incident("silent")
    frame = post.frame(incident, min_seq=0)
    assert (frame["seq"], frame["nodes"], frame["alarms"], frame["newest_t"]) == (0, [], [], None)
    assert get(post, incident, "tracks") == (200, {"tracks": []})


def test_an_entry_without_readings_counts_as_folded(post: Post) -> None:
    incident = post.open_incident("heartbeat only")
    post.telemetry(incident, "b1", [])
    assert post.frame(incident, min_seq=1)["seq"] == 1


def test_the_distance_is_as_uncertain_as_the_positions_along_it() -> None:
    relative = relative_position(
        Relative(delta_m=(3.0, 4.0, 0.0), covariance_m2=(4.0, 0.0, 0.0, 1.0, 0.0, 9.0))
    )
    assert relative.distance_m == 5.0
    assert relative.distance_sigma_m == pytest.approx(math.sqrt(0.36 * 4.0 + 0.64 * 1.0))
    here = relative_position(Relative(delta_m=(0.0, 0.0, 0.0), covariance_m2=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0)))
    assert here.distance_m == 0.0
    assert here.distance_sigma_m == pytest.approx(math.sqrt(3.0))
