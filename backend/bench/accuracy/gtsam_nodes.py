"""The nodes of the GTSAM peer: what is kept of each outside the graph."""

import bisect
import math
from dataclasses import dataclass, field

from backend.bench.accuracy.gtsam_factors import Offset
from estimator.measurements import Displacement

POSE_S = 1.0
FREE_POSE_S = 0.5
"""Poses of a responder without PDR: all that is measured in between is taken for one moment."""

Pose = tuple[float, float, float]
"""East, north (m), turn (rad)."""


@dataclass
class Fixed:
    """A node that stands.

    Attributes:
        key: of its `Pose2`, whose angle means nothing.
        pose: its newest estimate; None until it is begun.
        up_m: its height (m).
        by: who dropped it and when, while that is still to come.
    """

    key: int
    pose: Pose | None = None
    up_m: float = 0.0
    by: tuple[str, float] | None = None

    @property
    def begun(self) -> bool:
        """Whether it is in the graph."""
        return self.pose is not None


@dataclass
class Walker:
    """A responder: the way reckoned in its unit's frame, and poses about a second apart on it.

    Attributes:
        first_key: key of its first pose; the others follow.
        start_s: epoch of its introduction (s).
        up_m: its height, which is not estimated (m).
        reckons: it has PDR; None while that is not known.
        t_s: ends of displacements (s).
        way_m: where the unit reckons itself then, from its start, in its own frame (m).
        walked_m: length of the way until then (m).
        poses: index into `t_s` of each pose.
        pose: newest estimate of the last pose that is in the graph; None until it is begun.
        sent: so many poses are in the graph.
        turn_rad: what its frame's x axis is said to point to; None: it may point anywhere.
    """

    first_key: int
    start_s: float
    up_m: float = 0.0
    reckons: bool | None = None
    t_s: list[float] = field(default_factory=list)
    way_m: list[Offset] = field(default_factory=list)
    walked_m: list[float] = field(default_factory=list)
    poses: list[int] = field(default_factory=list)
    pose: Pose | None = None
    sent: int = 0
    turn_rad: float | None = None

    def __post_init__(self) -> None:
        self.t_s.append(self.start_s)
        self.way_m.append((0.0, 0.0))
        self.walked_m.append(0.0)
        self.poses.append(0)

    @property
    def begun(self) -> bool:
        """Whether it is in the graph."""
        return self.pose is not None

    @property
    def key(self) -> int:
        """Key of its last pose in the graph."""
        return self.first_key + self.sent - 1

    @property
    def turned(self) -> float:
        """By how much its frame is turned now (rad)."""
        return 0.0 if self.pose is None else self.pose[2]

    def move(self, reading: Displacement) -> None:
        """Take a displacement in; one that is older than the newest is too late for this peer."""
        if reading.t <= self.t_s[-1]:
            return
        self.reckons = True
        (east, north), (de, dn) = self.way_m[-1], reading.delta_m[:2]
        self.t_s.append(reading.t)
        self.way_m.append((east + de, north + dn))
        self.walked_m.append(self.walked_m[-1] + math.hypot(de, dn))
        if reading.t - self.t_s[self.poses[-1]] > POSE_S - 0.05:
            self.poses.append(len(self.t_s) - 1)

    def stay(self, t: float) -> None:
        """Without PDR: a reading at `t` calls for a pose near it."""
        if t - self.t_s[-1] >= FREE_POSE_S:
            self.t_s.append(t)
            self.way_m.append((0.0, 0.0))
            self.walked_m.append(0.0)
            self.poses.append(len(self.t_s) - 1)

    def covers(self, t: float) -> bool:
        """Whether it is known where the unit reckoned itself at `t`."""
        return t <= self.t_s[-1] + 1e-6 or self.reckons is False

    def at(self, t: float) -> tuple[int, Offset]:
        """The pose nearest to `t`, and the offset from it to where the unit was at `t`, in its frame (m)."""
        times = self.t_s
        right = min(max(bisect.bisect_left(times, t), 1), len(times) - 1)
        if len(times) == 1 or self.reckons is False:
            index = max(0, bisect.bisect_right(self.poses, t, key=lambda i: times[i]) - 1)
            return index, (0.0, 0.0)
        share = min(1.0, max(0.0, (t - times[right - 1]) / (times[right] - times[right - 1])))
        (e0, n0), (e1, n1) = self.way_m[right - 1], self.way_m[right]
        after = min(bisect.bisect_left(self.poses, t, key=lambda i: times[i]), len(self.poses) - 1)
        before = max(0, after - 1)
        near = min((before, after), key=lambda i: abs(times[self.poses[i]] - t))
        east, north = self.way_m[self.poses[near]]
        return near, (e0 + share * (e1 - e0) - east, n0 + share * (n1 - n0) - north)

    def from_start(self, t: float) -> Offset:
        """Where the unit reckoned itself at `t`, from its start, in its frame (m)."""
        index, (east, north) = self.at(t)
        way = self.way_m[self.poses[index]]
        return way[0] + east, way[1] + north


def ahead(pose: Pose, offset: Offset) -> Pose:
    """The pose after a displacement in its own axes (m)."""
    cosine, sine = math.cos(pose[2]), math.sin(pose[2])
    east = pose[0] + cosine * offset[0] - sine * offset[1]
    return east, pose[1] + sine * offset[0] + cosine * offset[1], pose[2]
