import importlib
from typing import Any

import pytest

from backend.bench.accuracy import gtsam_factors, gtsam_peer, least_squares
from backend.bench.accuracy.entrants import seconds
from backend.bench.accuracy.judge import judge
from estimator.measurements import Displacement, Drop, Node, Rssi
from estimator.simulate import Report
from tests.backend.bench.accuracy.short import ANCHORS, build, true_track

REPORTS = build(3).reports
TRUTH = {"ff": true_track()}


def with_node(changed: Node) -> list[Report]:
    """The reports, with another introduction of one node."""
    return [
        Report(changed, r.gateway, r.sent_s)
        if isinstance(r.reading, Node) and r.reading.node == changed.node
        else r
        for r in REPORTS
    ]


def test_what_is_posted_is_given_second_by_second() -> None:
    sent = [0.2, 1.0, 1.1, 4.0, 4.5]
    posted = list(seconds([Report(REPORTS[0].reading, "engine-1", t) for t in sent]))
    assert [[report.sent_s for report in second] for second in posted] == [[0.2, 1.0], [1.1], [4.0], [4.5]]


def test_the_peer_is_close_to_the_truth() -> None:
    online = judge(gtsam_peer.online(REPORTS), TRUTH, heights=False)
    smoothed = judge(gtsam_peer.smoothed(REPORTS), TRUTH, heights=False)
    assert online.errors.rmse_m < 0.3
    assert smoothed.errors.rmse_m < 0.2
    assert online.shown > 0.95


def test_the_peer_knows_only_what_has_been_posted() -> None:
    whole = gtsam_peer.online(REPORTS)["ff"]
    begun = gtsam_peer.online([report for report in REPORTS if report.sent_s <= 30.0])["ff"]
    assert begun == whole[: len(begun)]
    assert len(begun) > 25


def test_the_peer_finds_a_start_that_nobody_tells() -> None:
    unknown = Node(t=0.0, node="ff", role="responder", heading_sigma_rad=3.0)
    found = judge(gtsam_peer.online(with_node(unknown)), TRUTH, heights=False)
    assert found.errors.rmse_m < 0.5
    assert found.shown > 0.7


def test_the_peer_finds_a_beacon_that_nobody_tells() -> None:
    peer = gtsam_peer.Incremental()
    for report in with_node(Node(t=0.0, node="a2", role="beacon")):
        peer.graph.take(report.reading)
        peer.settle()
    assert peer.graph.fixed["a2"].pose is not None
    assert peer.graph.fixed["a2"].pose[:2] == pytest.approx(ANCHORS["a2"][:2], abs=1.0)


def test_the_peer_lays_a_breadcrumb_where_it_is_dropped() -> None:
    peer = gtsam_peer.Incremental()
    drop = Report(Drop(t=20.0, node="b1", by="ff"), "engine-1", 20.1)
    for report in sorted([*REPORTS, drop], key=lambda report: report.sent_s):
        peer.graph.take(report.reading)
        peer.settle()
    assert peer.graph.fixed["b1"].pose is not None
    assert peer.graph.fixed["b1"].pose[:2] == pytest.approx((17.0, 5.0), abs=0.5)


def test_without_pdr_the_peer_follows_ranges() -> None:
    ranged = [report for report in REPORTS if not isinstance(report.reading, Displacement)]
    found = judge(gtsam_peer.smoothed(ranged), TRUTH, heights=False)
    assert found.errors.rmse_m < 1.0


def test_rssi_in_db_has_the_derivatives_that_differences_have() -> None:
    make = gtsam_factors.Factors()
    gtsam = make.gtsam
    a, b = gtsam.symbol("x", 0), gtsam.symbol("x", 1)
    factor = make.rssi(Rssi(t=0.0, a="a", b="b", dbm=-60.0), (a, (0.3, -0.2)), (b, (0.1, 0.4)))
    values = gtsam.Values()
    values.insert(a, make.pose(1.0, 2.0, 0.4))
    values.insert(b, make.pose(-3.0, 4.0, -1.1))
    values.insert(make.path_loss, make.path_loss_guess())

    def moved(key: int, column: int, by: float) -> float:
        step: Any = gtsam.VectorValues()
        for other, width in ((a, 3), (b, 3), (make.path_loss, 2)):
            step.insert(other, [by if (other, i) == (key, column) else 0.0 for i in range(width)])
        return float(factor.unwhitenedError(values.retract(step))[0])

    columns = [(key, i) for key, width in ((a, 3), (b, 3), (make.path_loss, 2)) for i in range(width)]
    differences = [(moved(*one, 1e-6) - moved(*one, -1e-6)) / 2e-6 for one in columns]
    jacobian = factor.linearize(values).jacobian()[0][0]
    # The factor is weighted; its derivative by P0 is 1 without weight.
    assert differences == pytest.approx((jacobian / jacobian[6]).tolist(), abs=1e-5)


def test_without_gtsam_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(gtsam_factors.GtsamMissing, match="pip install gtsam"):
        gtsam_peer.online(REPORTS)


def test_least_squares_finds_each_second_alone() -> None:
    assert least_squares.takes(REPORTS)
    ranged = [report for report in REPORTS if not isinstance(report.reading, Rssi)]
    found = judge(least_squares.track(ranged), TRUTH, heights=False)
    assert found.errors.rmse_m < 0.4
    assert found.errors.coverage > 0.8
    assert found.shown > 0.95


def test_least_squares_leaves_scenarios_with_breadcrumbs_alone() -> None:
    drop = Report(Drop(t=20.0, node="b1", by="ff"), "engine-1", 20.1)
    assert not least_squares.takes([*REPORTS, drop])


def test_the_peer_gives_up_when_it_takes_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gtsam_peer, "GIVE_UP_S", -1.0)
    with pytest.raises(RuntimeError, match="not come to the end"):
        gtsam_peer.smoothed(REPORTS)
