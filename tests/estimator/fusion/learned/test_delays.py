"""Radios whose antenna delay is not calibrated are technologies by themselves."""

import pytest

from estimator.fusion import physics
from estimator.fusion.learned.calibration import bias_sigma_m
from estimator.fusion.learned.delays import delays, reported_as, source_of

OFF = {("uwb", "a1"), ("uwb", "ff1"), ("rtt", "a2")}


@pytest.mark.parametrize(
    ("technology", "ends", "source", "radios"),
    [
        ("uwb", ("a2", "ff2"), "uwb", 0),
        ("uwb", ("a1", "ff2"), "uwb of a1", 1),
        ("uwb", ("a1", "ff1"), "uwb of a1 ff1", 2),
        ("rtt", ("a1", "ff1"), "rtt", 0),
        ("rtt", ("ff1", "a2"), "rtt of a2", 1),
    ],
)
def test_a_range_counts_to_the_radios_at_its_ends_that_are_off(
    technology: str, ends: tuple[str, str], source: str, radios: int
) -> None:
    assert source_of(technology, *ends, OFF) == source_of(technology, *ends[::-1], OFF) == source
    assert reported_as(source) == technology
    assert delays(source) == radios


def test_each_radio_that_is_off_may_add_as_much() -> None:
    alone, one, two = (bias_sigma_m(name) ** 2 for name in ("uwb", "uwb of a1", "uwb of a1 ff1"))
    assert alone == physics.RANGE_BIAS_SIGMA_M["uwb"] ** 2
    assert one - alone == pytest.approx(physics.DELAY_SIGMA_M**2)
    assert two - one == pytest.approx(physics.DELAY_SIGMA_M**2)
