"""Ways of few numbers: their derivatives, and which of them ranges make likelier."""

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.smoothing.changes.short_tracks import RangedUnit, fit_along_unit, fit_freely
from estimator.smoothing.changes.track_fit import RangedTrack, look

THERE_M = np.array([[-15.0, -10.0], [18.0, -12.0], [3.0, 20.0]])
SECONDS = 20
CLEAR = 12.0
TURNS = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)


def walked() -> Array:
    """Round a corner at a metre a second."""
    along = np.minimum(np.arange(SECONDS + 1.0), 10.0)
    return np.column_stack([along, np.arange(SECONDS + 1.0) - along])


def heard(radio_m: Array, unit_m: Array, turn_rad: float = 0.0) -> RangedUnit:
    """Ranges each second, of a radio on one way, while its unit has gone another one."""
    chance = np.random.default_rng(5)
    t, at = np.repeat(np.arange(1.0, SECONDS + 1.0), 3), np.repeat(radio_m[1:], 3, axis=0)
    there, m = np.tile(THERE_M, (SECONDS, 1)), 3 * SECONDS
    range_m = np.hypot(*(at - there).T) + chance.normal(0.0, 0.1, m)
    noise = np.tile([0.1, 1.5, 3.0], (m, 1))
    cos, sin = np.cos(turn_rad), np.sin(turn_rad)
    own = unit_m @ np.array([[cos, -sin], [sin, cos]])

    def led(at_t: Array) -> Array:
        return np.column_stack([np.interp(at_t, np.arange(SECONDS + 1.0), own[:, c]) for c in (0, 1)])

    return RangedUnit(t, RangedTrack(there, np.zeros(m), range_m, np.full(m, 0.3), noise), led)


@pytest.mark.parametrize("led", [True, False])
def test_derivatives_are_those_of_finite_differences(led: bool) -> None:
    told = heard(walked(), walked())
    share = np.random.default_rng(6).uniform(0.0, 1.0, (len(told.t), 2))
    x = np.array([1.0, -2.0, 0.7]) if led else np.array([1.0, -2.0, 3.0, 0.5])
    basis = told.led(told.t) if led else share

    def residual(numbers: Array) -> tuple[Array, Array]:
        m = len(told.t)
        way, along, off = np.empty((m, 2)), np.empty((m, len(numbers))), np.empty(m)
        look(told.ranged, basis, led, numbers, way, along, off)
        return off, along

    for i, step in enumerate(1e-6 * np.eye(len(x))):
        slope = (residual(x + step)[0] - residual(x - step)[0]) / 2e-6
        assert residual(x)[1][:, i] == pytest.approx(-slope, abs=1e-6)


def test_a_unit_on_its_bearer_is_found_whatever_it_faces() -> None:
    told = heard(walked(), walked(), turn_rad=2.0)
    fit = fit_along_unit(told, np.array([5.0, 5.0]), TURNS)
    assert fit.way_m == pytest.approx(np.repeat(walked()[1:], 3, axis=0), abs=0.5)
    assert fit.x[-1] % (2.0 * np.pi) == pytest.approx(2.0, abs=0.05)
    assert fit.evidence > fit_freely(told, [fit.way_m]).evidence


def test_a_radio_that_lies_is_likelier_by_itself() -> None:
    told = heard(np.tile([4.0, 2.0], (SECONDS + 1, 1)), walked())
    unit = fit_along_unit(told, np.array([5.0, 5.0]), TURNS)
    free = fit_freely(told, [unit.way_m])
    assert free.evidence > unit.evidence + CLEAR
    assert free.way_m == pytest.approx(np.tile([4.0, 2.0], (len(told.t), 1)), abs=0.5)


def test_ranges_that_are_late_are_likelier_earlier() -> None:
    late = np.concatenate([walked()[:1], walked()[:1], walked()[:-2]])
    told = heard(late, walked())
    about = np.array([5.0, 5.0]), np.zeros(1)
    evidence = {
        late_s: fit_along_unit(told, *about, late_s).evidence for late_s in (-2.0, 0.0, 1.0, 2.0, 3.0)
    }
    assert max(evidence, key=lambda late_s: evidence[late_s]) == 2.0
