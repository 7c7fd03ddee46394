"""A snapshot that a tracker cannot go on from is refused."""

import pytest

from estimator import trackers
from estimator.trackers.base import TrackerSettings


@pytest.mark.parametrize("name", trackers.TRACKERS)
def test_a_snapshot_of_another_version_is_refused(name: str) -> None:
    state = bytearray(trackers.create(name, TrackerSettings()).snapshot())
    state[1] = 99
    with pytest.raises(ValueError, match="version 99"):
        trackers.restore(name, bytes(state))


@pytest.mark.parametrize("name", trackers.TRACKERS)
@pytest.mark.parametrize("state", [b"", b"nonsense", b"\xc1"])
def test_what_is_no_snapshot_is_refused(name: str, state: bytes) -> None:
    with pytest.raises(ValueError, match="no snapshot"):
        trackers.restore(name, state)


@pytest.mark.parametrize("name", trackers.TRACKERS)
def test_a_snapshot_that_was_cut_off_is_refused(name: str) -> None:
    state = trackers.create(name, TrackerSettings()).snapshot()
    with pytest.raises(ValueError, match="no snapshot"):
        trackers.restore(name, state[:-1])
