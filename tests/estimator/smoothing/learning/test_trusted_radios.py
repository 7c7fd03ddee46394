"""Radios that are off count as technologies of their own as long as nothing else explains their ranges."""

import numpy as np
import pytest

from estimator.fusion.memory.state import FusionState
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.learning.radios import Delay
from estimator.smoothing.learning.trusted_radios import distrust, trust_moved
from tests.estimator.smoothing.windows import fused


@pytest.fixture
def state() -> FusionState:
    """A responder who is ranged by an anchor, and by a breadcrumb that he has dropped."""
    return fused(
        [
            Node(t=0.0, node="a0", role="anchor", position_m=(5.0, 0.0, 0.0)),
            Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0)),
            Node(t=1.0, node="b0", role="breadcrumb"),
            Drop(t=1.0, node="b0", by="ff1"),
            *(Range(t=2.0, a="ff1", b=b, range_m=5.0, technology="uwb") for b in ("a0", "b0")),
        ]
    )


def counts_as(state: FusionState) -> set[str]:
    """What the ledger's ranges count as."""
    return {state.sources[number] for number in state.ledger.table("pairs")[:, 6].astype(np.intp).tolist()}


def off(state: FusionState) -> None:
    distrust(state, [Delay(("uwb", name), 9.0, 2.0, True, 0.0) for name in ("a0", "b0")])


def test_what_is_off_may_lie_elsewhere_where_nobody_has_told_its_place(state: FusionState) -> None:
    off(state)
    said = {notice.node: notice.text for notice in state.notices if "antenna delay" in notice.text}
    assert said == {
        "a0": "uwb ranges of a0 are off by +2.0 m: its antenna delay is not calibrated",
        "b0": "uwb ranges of b0 are off by +2.0 m: its antenna delay is not calibrated, "
        "or it lies elsewhere than it did",
    }


def test_the_radio_of_what_lies_elsewhere_is_trusted_again_and_no_other(state: FusionState) -> None:
    off(state)
    assert counts_as(state) == {"uwb of a0", "uwb of b0"}
    trust_moved(state, "b0")
    assert list(state.delayed) == [("uwb", "a0")]
    assert counts_as(state) == {"uwb of a0", "uwb"}
