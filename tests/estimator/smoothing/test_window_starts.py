"""What has been bent so that it does not find back by itself is begun again as it usually is."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.keyframes.walks import BIAS, SCALE
from estimator.smoothing.window_starts import as_usual
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of
from tests.estimator.smoothing.problem.test_marginals import prior_at
from tests.estimator.smoothing.windows import problem_of
from tests.estimator.trackers.entry import BASE, followed, off_m, surely_elsewhere

BEGAN_M = -2.0
ECHO_M = 3.0
SIGMA_M = 0.05


@dataclass(frozen=True)
class Entry:
    """Somebody goes in past the base; a vehicle ranges him thrice before walls hide it.

    Attributes:
        pace_mps: how fast.
        vehicle_m: where it stands.
        first_s: when it hears him first: each second second.
        echo_m: by what its first range is too long.
    """

    pace_mps: float = 0.6
    vehicle_m: tuple[float, float] = (-6.4, 10.3)
    first_s: int = 5
    echo_m: float = 0.0

    def at_m(self, second: float) -> tuple[float, float]:
        """Where he is."""
        return BEGAN_M + self.pace_mps * second, 0.0

    def readings(self, seconds: int) -> list[AnyReading]:
        """All that is told and measured until then."""
        rng = np.random.default_rng(0)
        told = [
            BASE,
            Node(t=0.0, node="v1", role="anchor", position_m=(*self.vehicle_m, 0.0), sigma_m=0.2),
            Node(t=0.0, node="ff1", role="responder", position_m=(BEGAN_M, 0.0, 0.0), sigma_m=0.5),
        ]
        ways = [
            Displacement(t=float(s), node="ff1", delta_m=(self.pace_mps, 0.0, 0.0), heading_rad=0.0)
            for s in range(1, seconds + 1)
        ]
        ranges = [
            self._range(second, "base", (0.0, 0.0), rng.normal(0.0, SIGMA_M))
            for second in range(2, seconds + 1, 2)
        ]
        for second in range(self.first_s, self.first_s + 6, 2):
            echo_m = self.echo_m if second == self.first_s else 0.0
            ranges.append(self._range(second, "v1", self.vehicle_m, echo_m + rng.normal(0.0, SIGMA_M)))
        return [*told, *ways, *ranges]

    def _range(self, second: int, to: str, place_m: tuple[float, float], off: float) -> Range:
        range_m = max(math.dist(self.at_m(second), place_m) + off, 0.0)
        return Range(t=float(second), a="ff1", b=to, range_m=range_m, technology="uwb")


@pytest.mark.parametrize("pace_mps", [0.6, 1.0])
@pytest.mark.parametrize("vehicle_m", [(-6.4, 10.3), (-4.0, 8.0)])
@pytest.mark.parametrize("first_s", [4, 5])
def test_an_echo_that_came_first_scales_no_map(
    pace_mps: float, vehicle_m: tuple[float, float], first_s: int
) -> None:
    """Ranges a fifth too long, and a crawl told a seventh too short, would agree with it for good."""
    entry = Entry(pace_mps, vehicle_m, first_s, ECHO_M)
    found = followed(entry.readings(60), 1)
    assert not surely_elsewhere(found, entry.at_m)
    assert off_m(found[-1][1], entry.at_m(60.0)) < 0.6


def test_units_and_radios_that_are_as_usual_are_begun_once() -> None:
    problem, solved = solved_of(Entry().readings(30))
    assert as_usual(problem, solved.x) is None


@pytest.mark.parametrize("strange", ["bias", "scale", "range scale", "range bias"])
def test_what_hardly_one_unit_or_radio_is_off_by_is_begun_again_without(strange: str) -> None:
    problem, solved = solved_of(Entry().readings(30))
    layout, bent = problem.layout, solved.x.copy()
    size, begins = layout.length * layout.width, layout.walks[0].first * layout.width
    ranges = size + next(start for (kind, _), start in layout.technologies.items() if kind == "range")
    at, by = {
        "bias": (begins + BIAS, math.radians(1.5)),
        "scale": (begins + SCALE, 0.3),
        "range scale": (ranges, 0.2),
        "range bias": (ranges + 1, 2.0),
    }[strange]
    bent[at] = by
    usual = as_usual(problem, bent)
    assert usual is not None
    assert usual[at] == 0.0
    first_m, last_m = (layout.states(usual, 0)[k, :2] for k in (0, -1))
    assert np.array_equal(first_m, layout.states(bent, 0)[0, :2])
    gone_m = 0.6 * float(layout.times[-1, 0] - layout.times[0, 0])
    assert math.dist(last_m, first_m) == pytest.approx(gone_m, rel=0.01)


def test_a_window_that_has_forgotten_where_they_began_begins_nobody_again() -> None:
    problem, solved = solved_of(Entry().readings(30))
    layout, bent = problem.layout, solved.x.copy()
    bent[layout.walks[0].first * layout.width + BIAS] = math.radians(1.5)
    assert as_usual(problem, bent) is not None
    cut = layout.length // 2
    later = problem_of(layout.state, float(layout.grid[cut]), prior_at(problem, solved, cut))
    assert as_usual(later, bent[cut * layout.width :]) is None
