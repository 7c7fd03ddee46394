"""A scenario's readings become the batches that its gateways post."""

import pytest

from backend.demo.batching import batches_of, body_of, gateways_of
from backend.log.decode import judge
from estimator.simulate import Scenario, scenario, scenario_names

START = 1_763_712_345.0


@pytest.fixture(scope="module", params=scenario_names())
def played(request: pytest.FixtureRequest) -> Scenario:
    return scenario(request.param, seed=1)


def test_every_reading_is_in_one_batch_of_its_gateway(played: Scenario) -> None:
    assert set(gateways_of(played.reports)) == {report.gateway for report in played.reports}
    for gateway in gateways_of(played.reports):
        posted = [r for batch in batches_of(played.reports, gateway) for r in batch.readings]
        assert posted == [report.reading for report in played.reports if report.gateway == gateway]


def test_no_reading_waits_longer_than_half_a_second_for_its_batch(played: Scenario) -> None:
    sent = {id(report.reading): report.sent_s for report in played.reports}
    for gateway in gateways_of(played.reports):
        for batch in batches_of(played.reports, gateway):
            assert all(0.0 < batch.due_s - sent[id(r)] <= 0.5 + 1e-9 for r in batch.readings)


def test_the_log_takes_every_reading_on_a_live_clock(played: Scenario) -> None:
    for gateway in gateways_of(played.reports):
        for batch in batches_of(played.reports, gateway):
            judged = judge(body_of(batch, gateway, "b1", START), 10_000, START + batch.due_s)
            assert judged.rejected == ()
            assert len(judged.accepted) == len(batch.readings)
            assert judged.sent == pytest.approx(START + batch.due_s)
