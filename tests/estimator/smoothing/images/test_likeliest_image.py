"""Somebody who is followed by ranges alone, where two radios do not tell on which side of them he is."""

import numpy as np
import pytest

from estimator.estimate import NodeEstimate
from estimator.fusion.images import mirrored
from estimator.measurements import AnyReading
from estimator.measurements.drop import Drop
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.smoothing.images.alternatives import Mode, alternatives_now, same_now, widen
from estimator.smoothing.images.likeliest_image import likeliest_image
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.smoothing.images.test_flip_ambiguity import (
    CORNERS,
    CROSSED_S,
    TWO,
    crossing,
    places,
    solved_of,
)

LINE = mirrored(np.zeros(2), 0.0)


def lingering() -> list[AnyReading]:
    """He comes to the line, stays there for a minute, and goes on: nobody can tell whether he turned back."""
    chance = np.random.default_rng(5)
    readings: list[AnyReading] = [r for r in crossing(TWO) if not isinstance(r, Range)]
    for second in range(1, 121):
        north_m = -20.0 + second if second < 20 else 0.0 if second < 80 else second - 80.0
        for name, (e, n) in TWO.items():
            range_m = float(np.hypot(12.0 - e, north_m - n) + chance.normal(0.0, 0.1))
            readings.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
    return readings


def after(readings: list[AnyReading]) -> NodeEstimate:
    """How he is shown at the end."""
    return every(readings)["ff1"]


def every(readings: list[AnyReading]) -> dict[str, NodeEstimate]:
    """How everybody is shown at the end."""
    tracker = KirchhoffTracker(TrackerSettings())
    for reading in readings:
        tracker.fold([reading])
    return {e.node: e for e in tracker.estimates()}


def test_who_walks_on_across_the_line_is_shown_beyond_it() -> None:
    found = after(crossing(TWO))
    assert found.position_m is not None
    assert found.position_m[:2] == pytest.approx((12.0, 20.0), abs=1.0)


def test_who_lingered_on_the_line_may_be_on_either_side_and_is_said_to() -> None:
    found = after(lingering())
    assert found.position_m is not None
    assert found.covariance_m2 is not None
    assert abs(found.position_m[1]) == pytest.approx(40.0, abs=1.0)
    assert np.sqrt(found.covariance_m2[3]) > 20.0
    assert np.sqrt(found.covariance_m2[0]) < 2.0


def test_a_third_radio_tells_the_side() -> None:
    radios = TWO | {"a3": (32.0, 10.0)}
    entered = [r for r in crossing(radios) if not isinstance(r, Range)]
    rests = [
        Range(t=float(second), a="ff1", b=name, range_m=float(np.hypot(12.0 - e, 40.0 - n)), technology="uwb")
        for second in range(121, 128)
        for name, (e, n) in radios.items()
    ]
    found = after([*entered, *(r for r in lingering() if isinstance(r, Range)), *rests])
    assert found.position_m is not None
    assert found.covariance_m2 is not None
    assert found.position_m[1] == pytest.approx(40.0, abs=1.5)
    assert np.sqrt(found.covariance_m2[3]) < 2.0


def test_whose_life_has_ended_where_nobody_could_tell_stays_on_either_side() -> None:
    found = after([*lingering(), Retire(t=121.0, node="ff1")])
    assert found.retired
    assert found.covariance_m2 is not None
    assert np.sqrt(found.covariance_m2[3]) > 20.0


def test_a_wrong_side_is_left_for_the_right_one() -> None:
    problem, solved = solved_of(crossing(TWO))
    layout, x = problem.layout, solved.x.copy()
    states = x[: layout.length * layout.width].reshape(layout.length, layout.width)
    LINE.move(states[layout.length // 2 :])
    wrong = problem.solve(x)
    assert places(problem, wrong)[-1, 1] < -15.0
    judged = likeliest_image(problem, wrong)
    assert places(problem, judged.solved)[-1, 1] == pytest.approx(20.0, abs=1.0)
    assert judged.solved.cost < wrong.cost
    assert judged.exposed


def test_who_hears_radios_about_him_is_nowhere_else() -> None:
    problem, solved = solved_of(crossing(CORNERS))
    judged = likeliest_image(problem, solved)
    assert judged.solved is solved
    assert not judged.modes
    assert not judged.exposed


def test_of_whom_nobody_knew_before_it_is_asked_again_soon_where_he_is() -> None:
    """Hardly anything tells yet; later he hears radios about him."""
    entered, later = ([r for r in crossing(CORNERS) if r.t <= until_s] for until_s in (2.0, 40.0))
    assert likeliest_image(*solved_of(entered)).exposed
    assert not likeliest_image(*solved_of(later)).exposed


def test_what_he_drops_where_nobody_can_tell_may_lie_on_either_side() -> None:
    found = every([*lingering(), Drop(t=120.5, node="b1", by="ff1")])["b1"]
    assert found.position_m is not None
    assert found.covariance_m2 is not None
    assert abs(found.position_m[1]) == pytest.approx(40.0, abs=1.0)
    assert np.sqrt(found.covariance_m2[3]) > 20.0


def test_covariances_hold_where_everybody_may_have_been_and_in_between() -> None:
    problem, solved = solved_of(crossing(TWO))
    layout = problem.layout
    there = np.random.default_rng(1).normal(0.0, 3.0, len(solved.x)) + solved.x
    solved.chain.solve()
    before = tuple(part.copy() for part in solved.chain.covariances())
    found = tuple(part.copy() for part in before)
    widen(layout, solved.x, [Mode(0, 0.3, there, 0.0, LINE, {})], (found[0], found[1], found[2]))
    size = layout.length * layout.width
    off = (there - solved.x)[:size].reshape(layout.length, layout.width)[:, :2]
    for k in range(layout.length):
        more = found[0][k, 0] - before[0][k, 0]
        assert more[:2, :2] == pytest.approx(0.3 * np.outer(off[k], off[k]), abs=1e-9)
        assert not more[2:].any()
    assert (found[1] - before[1])[3, 0, :2, :2] == pytest.approx(0.3 * np.outer(off[3], off[4]), abs=1e-9)
    start = next(iter(layout.stands.values()))
    still = (there - solved.x)[size:][start : start + 2]
    assert (found[2] - before[2])[start : start + 2, start : start + 2] == pytest.approx(
        0.3 * np.outer(still, still), abs=1e-9
    )


def test_who_may_be_elsewhere_is_told_where_and_since_when() -> None:
    problem, solved = solved_of(crossing(TWO))
    layout, x = problem.layout, solved.x.copy()
    walk, since = layout.walks[0], layout.length // 2
    LINE.move(x[: layout.length * layout.width].reshape(layout.length, layout.width)[since:])
    since_t = float(layout.grid[since])
    found = alternatives_now(
        layout, solved.x, [Mode(walk.number, 0.4, x, since_t, LINE, {walk.number: LINE})]
    )
    (other,) = found["ff1"]
    here = places(problem, solved)[-1]
    assert other.image.of(here) == pytest.approx(LINE.of(here), abs=1e-9)
    assert (other.share, other.since_t) == (0.4, since_t)
    assert not found["a1"]


def test_who_crosses_the_line_just_where_his_image_does_may_go_on_to_either_side() -> None:
    """Both are at one place for a second; what each goes on by is not the same."""
    problem, solved = solved_of([r for r in crossing(TWO) if r.t <= CROSSED_S])
    layout, x = problem.layout, solved.x.copy()
    walk, states = layout.walks[0], layout.states(x, 0)
    LINE.move(states)
    here = states[-1, :2] = places(problem, solved)[-1]
    assert not same_now(layout, solved.x, x)
    found = alternatives_now(layout, solved.x, [Mode(walk.number, 0.5, x, 0.0, LINE, {walk.number: LINE})])
    (other,) = found["ff1"]
    assert other.image.of(here) == pytest.approx(here, abs=1e-9)
    states[-1, 3:5] = layout.states(solved.x, 0)[-1, 3:5]
    assert same_now(layout, solved.x, x)
