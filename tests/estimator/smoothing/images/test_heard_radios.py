"""What somebody has heard of radios that stand, and what that says of images of where he was."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.images import Image
from estimator.measurements.range import Range
from estimator.smoothing.images.heard_radios import heard_by, radios_of
from estimator.smoothing.images.symmetries import across
from tests.estimator.smoothing.images.test_flip_ambiguity import CORNERS, TWO, crossing, solved_of


def test_what_was_heard_of_radios_is_all_that_stand() -> None:
    problem, solved = solved_of(crossing(TWO))
    heard = heard_by(problem, solved, problem.layout.walks[0])
    assert sorted(set(map(tuple, heard.radio_m.round(1).tolist()))) == sorted(TWO.values())
    ranges_m = np.hypot(*(heard.here_m - heard.radio_m).T)
    measured = [r.range_m for r in crossing(TWO) if isinstance(r, Range)]
    assert sorted(ranges_m) == pytest.approx(sorted(measured), abs=0.5)


def test_two_radios_on_one_mast_are_on_no_line() -> None:
    """As on a vehicle: not they, but the next radio tells in which line he may be at his image."""
    mast = {"a1": (0.0, 0.0), "a2": (0.0, 0.05), "a3": (20.0, 0.0)}
    problem, solved = solved_of(crossing(mast))
    heard = heard_by(problem, solved, problem.layout.walks[0])
    assert sorted(at_m[0].round(1) for at_m in radios_of(heard)) == [0.0, 20.0]
    assert len(radios_of(heard.some(heard.radio_m[:, 0] < 10.0))) == 1


def test_two_radios_tell_no_side_and_a_third_beside_their_line_does() -> None:
    for radios, known in ((TWO, False), (CORNERS, True)):
        problem, solved = solved_of(crossing(radios))
        heard = heard_by(problem, solved, problem.layout.walks[0])
        mirrored = [image for image, _ in across([np.array(at) for at in TWO.values()], heard.here_m)]
        assert mirrored
        assert all(heard.contradicts(image) == known for image in mirrored)


@given(st.floats(8.0, 50.0), st.floats(-math.pi, math.pi))
def test_nobody_was_metres_from_where_his_ranges_put_him(by_m: float, towards_rad: float) -> None:
    problem, solved = solved_of(crossing(CORNERS))
    heard = heard_by(problem, solved, problem.layout.walks[0])
    assert not heard.contradicts(Image())
    moved = Image(east_m=by_m * math.cos(towards_rad), north_m=by_m * math.sin(towards_rad))
    assert heard.contradicts(moved)


def test_who_has_heard_nothing_is_nowhere_else() -> None:
    problem, solved = solved_of(crossing(TWO))
    heard = heard_by(problem, solved, problem.layout.walks[0])
    assert heard.some(heard.t < 0.0).contradicts(Image())
