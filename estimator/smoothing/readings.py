"""Every reading of an incident, held against keyframes and what stands."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.held import measured
from estimator.fusion.noise import Link, link_sigma
from estimator.fusion.rows import End, Linear, Pair, PairKind, Rows, Stack
from estimator.graph.dense import Array, Indices
from estimator.graph.robust import Mixture
from estimator.graph.variable import Variable
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude, Pressure, height_above
from estimator.measurements.bearing import Bearing
from estimator.measurements.drop import Drop
from estimator.measurements.position import Position, east_north_up
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.smoothing.problem import Problem

DROP_NOISE = Mixture(outliers=0.02, shift=0.0, spread=3.0)
STILL: tuple[float, float, float] = (0.0, 0.0, 0.0)


class Where(NamedTuple):
    """A node at one epoch.

    Attributes:
        variable: its block; None: it is fixed.
        place_m: where it is fixed.
        walk: index of its walk; -1 where it stands.
        t: the epoch.
    """

    variable: Variable | None
    place_m: tuple[float, float, float]
    walk: int
    t: float


class Offsets:
    """Where moving ends stood from their keyframes, m × 3, by what the estimate says of their units."""

    def __init__(self, problem: Problem, ends: Sequence[Where]) -> None:
        self._still = np.array([e.place_m for e in ends]).reshape(len(ends), 3)
        walks = np.array([e.walk for e in ends], dtype=np.intp)
        epochs = np.array([e.t for e in ends])
        self._start: Indices = np.array(
            [problem.starts[e.variable] if e.walk >= 0 and e.variable is not None else 0 for e in ends],
            dtype=np.intp,
        )
        keyframe = np.array([e.variable.epoch or 0.0 if e.walk >= 0 and e.variable else 0.0 for e in ends])
        since = problem.epochs[keyframe.astype(np.intp)] if len(ends) else epochs
        self._duration = epochs - since
        self._delta = np.zeros((len(ends), 3))
        self._unit = np.zeros(len(ends), dtype=bool)
        self._free = np.zeros(len(ends), dtype=bool)
        for index, walk in enumerate(problem.walks):
            mine = walks == index
            if not walk.is_unit():
                self._free |= mine
                continue
            self._unit |= mine
            self._delta[mine] = (walk.summed(epochs[mine]) - walk.summed(since[mine]))[:, :3]

    def at(self, x: Array) -> Array:
        """The offsets at an estimate x."""
        offset = self._still.copy()
        free, unit = self._free, self._unit
        for axis in range(3):
            offset[free, axis] = x[self._start[free] + 3 + axis] * self._duration[free]
        psi, scale = x[self._start[unit] + 3], 1.0 + x[self._start[unit] + 5]
        cosine, sine = np.cos(psi) * scale, np.sin(psi) * scale
        e, n, u = self._delta[unit].T
        offset[unit] = np.column_stack([cosine * e - sine * n, sine * e + cosine * n, scale * u])
        return offset


class Readings:
    """All rows of the problem, linearised together.

    Attributes:
        stack: priors, fixes and heights, then pairs by kind.
        sigma, outliers, shift, spread: of all rows, drops last.
    """

    def __init__(self, problem: Problem, readings: Sequence[AnyReading]) -> None:
        self._problem = problem
        self._names = {walk.node.node: i for i, walk in enumerate(problem.walks)}
        self._links: dict[str, Link] = {}
        self._ways = [walk.lengths(problem.epochs, problem.x, problem.starts) for walk in problem.walks]
        linear: list[tuple[Linear, Where]] = []
        pairs: dict[str, list[tuple[Pair, Where, Where]]] = {"range": [], "rssi": [], "bearing": []}
        drops: list[tuple[Variable, Where]] = []
        reference: float | None = None
        for reading in readings:
            if isinstance(reading, Pressure) and self._role(reading.node) == "base":
                reference = reading.pressure_pa
            elif isinstance(reading, Position | Altitude | Pressure):
                linear += self._absolute(reading, reference)
            elif isinstance(reading, Drop):
                by = self._where(reading.by, reading.t)
                on = self._where(reading.node, reading.t)
                if by is not None and on is not None and on.variable is not None and by.variable is not None:
                    drops.append((on.variable, by))
            elif isinstance(reading, Range | Rssi | Bearing):
                a, b = self._where(reading.a, reading.t), self._where(reading.b, reading.t)
                made = self._pair(reading, a, b)
                if made is not None and a is not None and b is not None:
                    pairs[made.kind].append((made, a, b))
        priors = [(p, Where(None, STILL, -1, 0.0)) for p in problem.priors]
        linear = priors + linear
        flat = [p for group in pairs.values() for p in group]
        self.stack = Stack(problem.starts, [row for row, _ in linear], [p for p, _, _ in flat])
        self._value = np.array([row.value for row, _ in linear])
        self._axis = np.array([row.axis if w.walk >= 0 else -1 for row, w in linear], dtype=np.intp)
        self._linear = Offsets(problem, [w for _, w in linear])
        self._ends = [
            (Offsets(problem, [a for _, a, _ in group]), Offsets(problem, [b for _, _, b in group]))
            for group in pairs.values()
            if group
        ]
        self._drops = Offsets(problem, [by for _, by in drops])
        on_rows = np.array([problem.starts[on] for on, _ in drops], dtype=np.intp)
        by_rows = np.array([problem.starts[w.variable] for _, w in drops if w.variable], dtype=np.intp)
        axes = np.arange(3)
        self._drop_columns = np.zeros((3 * len(drops), 8), dtype=np.intp)
        self._drop_columns[:, 0] = (on_rows[:, None] + axes).ravel()
        self._drop_columns[:, 1] = (by_rows[:, None] + axes).ravel()
        count = 3 * len(drops)
        self.sigma = np.r_[self.stack.sigma, np.tile(physics.DROP_SIGMA_M, len(drops))]
        self.outliers = np.r_[self.stack.outliers, np.full(count, DROP_NOISE.outliers)]
        self.shift = np.r_[self.stack.shift, np.full(count, DROP_NOISE.shift)]
        self.spread = np.r_[self.stack.spread, np.full(count, DROP_NOISE.spread)]
        self.metric = np.array(
            [s in ("", *physics.RANGE_SIGMA_M) for s in self.stack.sources] + [True] * count
        )

    def _role(self, name: str) -> str | None:
        node = self._problem.pace.state.nodes.get(name)
        return None if node is None else node.role

    def _where(self, name: str, t: float) -> Where | None:
        """A node at an epoch; None where it has no position then."""
        problem = self._problem
        if name in self._names:
            walk = problem.walks[self._names[name]]
            keyframe = int(np.searchsorted(problem.epochs, t, side="right")) - 1
            if not walk.first <= keyframe <= walk.last:
                return None
            return Where(Variable("position", name, float(keyframe)), STILL, self._names[name], t)
        if name in problem.standing:
            since = [v for epoch, v in problem.standing[name] if epoch <= t]
            return Where(since[-1], STILL, -1, t) if since else None
        node = problem.pace.state.nodes.get(name)
        if node is None or node.place_m is None or node.role != "base":
            return None
        return Where(None, node.place_m, -1, t)

    def _absolute(
        self, reading: Position | Altitude | Pressure, reference: float | None
    ) -> list[tuple[Linear, Where]]:
        where = self._where(reading.node, reading.t)
        if where is None or where.variable is None:
            return []
        floor = physics.SIGMA_FLOOR_M
        if isinstance(reading, Position):
            origin = self._problem.pace.state.origin_wgs84
            position = reading.position_m
            if position is None and reading.wgs84 is not None and origin is not None:
                position = east_north_up(reading.wgs84, origin)
            if position is None:
                return []
            sigma = reading.sigma_m or physics.FIX_SIGMA_M
            return [
                (Linear(where.variable, i, position[i], max(sigma[i], floor), physics.FIX_NOISE), where)
                for i in range(3)
            ]
        if isinstance(reading, Altitude):
            up, spread = reading.up_m, reading.sigma_m or physics.ALTITUDE_SIGMA_M
        elif reference is None:
            return []
        else:
            above = height_above(reference, reading.pressure_pa)
            up = self._problem.pace.state.base_place()[2] + above
            spread = float(np.hypot(reading.sigma_m or physics.PRESSURE_SIGMA_M, physics.LAYER_SIGMA * above))
            # One reading a second, each as one of those that share an error.
            spread *= float(np.sqrt(physics.PRESSURE_CORRELATION_S))
        return [(Linear(where.variable, 2, up, max(spread, floor), physics.HEIGHT_NOISE), where)]

    def _pair(self, reading: Range | Rssi | Bearing, a: Where | None, b: Where | None) -> Pair | None:
        if a is None or b is None or (a.variable is None and b.variable is None):
            return None
        keyframes = {w.variable.epoch for w in (a, b) if w.walk >= 0 and w.variable is not None}
        if len(keyframes) > 1:
            return None
        ends = End(a.variable, STILL), End(b.variable, STILL)
        state = self._problem.pace.state
        if isinstance(reading, Bearing):
            if reading.frame == "body":
                return None
            sigma = max(reading.sigma_rad or physics.BEARING_SIGMA_RAD, physics.HEADING_FLOOR_RAD)
            return Pair(
                "bearing", *ends, None, reading.bearing_rad, sigma, physics.BEARING_NOISE, "bearing", sigma
            )
        value, sigma, owner, sent = measured(reading)
        if isinstance(reading, Range):
            states, source, noise = Variable("range", owner), owner, physics.RANGE_NOISE
        else:
            states, source, noise = Variable("rssi", owner), f"rssi {owner}", physics.RSSI_NOISE
        if states not in self._problem.starts:
            return None
        kind: PairKind = "range" if isinstance(reading, Range) else "rssi"
        link = f"{source} {min(reading.a, reading.b)} {max(reading.a, reading.b)}"
        known, way = self._links.get(link), self._way(a) + self._way(b)
        newest = Link(reading.t, way) if known is None else known.next(reading.t, way)
        self._links[link] = newest
        spread = link_sigma(state.learned(source), sigma, newest.alike)
        return Pair(kind, *ends, states, value, spread, noise, source, sigma, link, sent)

    def _way(self, where: Where) -> float:
        """How far a node had walked by then (m)."""
        if where.walk < 0 or where.variable is None:
            return 0.0
        return float(self._ways[where.walk][int(where.variable.epoch or 0.0)])

    def linearise(self, x: Array) -> Rows:
        """All rows at an estimate x."""
        moved = self._linear.at(x)
        shifted = np.where(self._axis >= 0, moved[np.arange(len(moved)), self._axis], 0.0)
        self.stack.value[:] = self._value - shifted
        for group, (a, b) in zip(self.stack.groups, self._ends, strict=True):
            group.offset_a, group.offset_b = a.at(x), b.at(x)
        rows = self.stack.linearise(x)
        jacobian = np.zeros((len(self._drop_columns), 8))
        jacobian[:, 0], jacobian[:, 1] = 1.0, -1.0
        at = x[self._drop_columns]
        residual = self._drops.at(x).ravel() - (at[:, 0] - at[:, 1])
        return Rows(
            np.concatenate([rows.columns, self._drop_columns]),
            np.concatenate([rows.jacobian, jacobian]),
            np.concatenate([rows.residual, residual]),
        )
