"""What a scenario is: readings as gateways post them, and the truth, kept apart from them."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from estimator.measurements import AnyReading

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Storey:
    """One storey of a building.

    Attributes:
        level: integer storey, ground 0.
        name: how it is spoken of.
        up_m: height of its floor (m).
    """

    level: int
    name: str
    up_m: float


@dataclass(frozen=True, slots=True)
class TrueTrack:
    """Where one node truly was; never given to a tracker.

    Attributes:
        t_s: epochs, ascending, n (s).
        position_m: east, north, up, n × 3 (m).
        level: integer storey, n.
        heading_rad: where it faces, from east, anticlockwise, unwrapped, n (rad).
    """

    t_s: FloatArray
    position_m: FloatArray
    level: IntArray
    heading_rad: FloatArray

    def at(self, t_s: FloatArray) -> FloatArray:
        """Positions at epochs `t_s` (m), m × 3, interpolated; the ends are held."""
        return np.stack([np.interp(t_s, self.t_s, self.position_m[:, axis]) for axis in range(3)], axis=1)

    def heading_at(self, t_s: FloatArray) -> FloatArray:
        """Headings at epochs `t_s`, unwrapped, m (rad)."""
        return np.interp(t_s, self.t_s, self.heading_rad)

    def level_at(self, t_s: FloatArray) -> IntArray:
        """Levels at epochs `t_s`, m: the newest one known then."""
        newest = np.searchsorted(self.t_s, t_s, side="right") - 1
        levels: IntArray = self.level[np.clip(newest, 0, len(self.t_s) - 1)]
        return levels

    @property
    def distance_m(self) -> float:
        """Length of the way walked (m)."""
        return float(np.linalg.norm(np.diff(self.position_m, axis=0), axis=1).sum())


def static_track(position_m: FloatArray, level: int, start_s: float, end_s: float) -> TrueTrack:
    """The truth of a node that stays at `position_m`, shape (3,) (m), from `start_s` to `end_s`."""
    return TrueTrack(np.array([start_s, end_s]), np.tile(position_m, (2, 1)), np.full(2, level), np.zeros(2))


@dataclass(frozen=True, slots=True)
class Report:
    """A reading on its way to the server.

    Attributes:
        reading: what was measured.
        gateway: who posts it.
        sent_s: when it is posted, in the scenario's time (s); not before `reading.t`.
    """

    reading: AnyReading
    gateway: str
    sent_s: float


@dataclass(frozen=True, slots=True)
class Scenario:
    """An experiment: everything that is posted, and what was true.

    Attributes:
        name: the name it is called by.
        incident: the incident's name on the screen.
        clock: the incident's clock.
        storeys: the building's storeys; empty where there is but one plane.
        reports: readings in order of posting; `t` counts from 0 at the scenario's start.
        truth: the true track of each node, by its name.
        duration_s: how long it lasts (s).
    """

    name: str
    incident: str
    clock: Literal["live", "recorded"]
    storeys: tuple[Storey, ...]
    reports: tuple[Report, ...]
    truth: dict[str, TrueTrack] = field(repr=False)
    duration_s: float

    @property
    def readings(self) -> list[AnyReading]:
        """The readings in the order in which the server gets them."""
        return [report.reading for report in self.reports]


def in_posting_order(reports: list[Report]) -> tuple[Report, ...]:
    """`reports` sorted by when they are posted, then by epoch; equal ones keep their order."""
    return tuple(sorted(reports, key=lambda report: (report.sent_s, report.reading.t)))
