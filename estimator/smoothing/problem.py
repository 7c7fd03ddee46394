"""A whole incident as one least-squares problem: who moves, who stands, and how the numbers are laid out."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from estimator.fusion import physics
from estimator.fusion.introduce import initial_turn
from estimator.fusion.nodes import NodeState
from estimator.fusion.rows import Linear
from estimator.graph.dense import Array
from estimator.graph.robust import Mixture
from estimator.graph.variable import DIMENSION, Variable
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.smoothing.pace import Pace
from estimator.smoothing.walks import Walk, unit_walk

STATES = 6
LARGEST = 60_000_000
"""Numbers that the chain may hold: beyond it keyframes are set farther apart."""
SURE = Mixture(outliers=1e-9, shift=0.0, spread=1.0)
FAR_M = 1e4
STANDING = ("anchor", "beacon", "breadcrumb")


class Problem:
    """Layout of the unknowns, where they start, and their priors.

    Attributes:
        pace: the online pass.
        walks: the moving nodes, each with its own six columns of every keyframe.
        epochs: of the keyframes, k (s).
        starts: where each block starts; keyframes come first, what lasts after them.
        standing: blocks of each static node, with the epoch from which each holds: one for each drop.
        x: the unknowns where they start, flat.
        priors: what is known beforehand.
    """

    def __init__(self, pace: Pace, readings: Sequence[AnyReading]) -> None:
        self.pace = pace
        self.priors: list[Linear] = []
        self.walks: list[Walk] = []
        self.starts: dict[Variable, int] = {}
        self.standing: dict[str, list[tuple[float, Variable]]] = {}
        spans = self._spans(readings)
        begin = math.floor(min((a for a, _ in spans.values()), default=0.0))
        end = math.ceil(max((b for _, b in spans.values()), default=begin + 1.0))
        lasting = self._lasting(readings)
        size = sum(DIMENSION[v.kind] for v in lasting)
        width = STATES * len(spans)
        spacing = 1
        while (end - begin) / spacing * width * (size + 2 * width) > LARGEST and end - begin > spacing:
            spacing *= 2
        self.epochs: Array = np.arange(begin, end + spacing, spacing, dtype=np.float64)
        self.width = width
        start = len(self.epochs) * width
        for variable in lasting:
            self.starts[variable] = start
            start += DIMENSION[variable.kind]
        self.x: Array = np.zeros(start)
        self.border = size
        for name, span in spans.items():
            self._add_walk(name, span, readings)
        self._begin_lasting(lasting, readings)

    def _spans(self, readings: Sequence[AnyReading]) -> dict[str, tuple[float, float]]:
        """First and last epoch of each moving node that the online pass placed."""
        spans: dict[str, tuple[float, float]] = {}
        for name, poses in self.pace.poses.items():
            spans[name] = poses[0][0], poses[-1][0]
        for reading in readings:
            if isinstance(reading, Displacement) and reading.node in spans:
                first, last = spans[reading.node]
                spans[reading.node] = min(first, reading.t - 1.0), max(last, reading.t)
        return spans

    def _lasting(self, readings: Sequence[AnyReading]) -> list[Variable]:
        graph = self.pace.state.graph
        for node in self.pace.state.nodes.values():
            if node.mode == "static" or (node.mode == "retired" and node.role in STANDING and node.place_m):
                self.standing[node.node] = [(-math.inf, node.position)]
        for reading in readings:
            if isinstance(reading, Drop) and reading.node in self.standing:
                known = self.standing[reading.node]
                if known[-1][0] == -math.inf:
                    known.clear()
                known.append((reading.t, Variable("position", f"{reading.node} {len(known)}")))
        blocks = [v for blocks in self.standing.values() for _, v in blocks]
        return blocks + [v for v in graph.starts if v.kind in ("range", "rssi")]

    def _add_walk(self, name: str, span: tuple[float, float], readings: Sequence[AnyReading]) -> None:
        node = self.pace.state.nodes[name]
        reports = [r for r in readings if isinstance(r, Displacement) and r.node == name]
        first = int(np.searchsorted(self.epochs, span[0], side="right")) - 1
        last = int(np.searchsorted(self.epochs, span[1], side="left"))
        first, last = max(first, 0), min(last, len(self.epochs) - 1)
        column = STATES * len(self.walks)
        if reports:
            walk = unit_walk(node, span[0], reports, (first, last))
        else:
            walk = Walk(node, first, last, np.zeros((0, 10)), [])
        rest: Literal["unit", "velocity"] = "unit" if reports else "velocity"
        alive = np.arange(first, last + 1)
        begins = self.pace.along(name, bool(reports), self.epochs[alive])
        for keyframe, value in zip(alive.tolist(), begins, strict=True):
            start = keyframe * self.width + column
            self.starts[Variable("position", name, float(keyframe))] = start
            self.starts[Variable(rest, name, float(keyframe))] = start + 3
            self.x[start : start + STATES] = value
        self.walks.append(walk)
        self._walk_priors(walk, reports, readings)

    def _walk_priors(
        self, walk: Walk, reports: Sequence[Displacement], readings: Sequence[AnyReading]
    ) -> None:
        name, keyframe = walk.node.node, float(walk.first)
        position = Variable("position", name, keyframe)
        where, sigma = self._entry(walk.node, reports, readings)
        self.priors += [Linear(position, i, where[i], sigma[i], SURE) for i in range(3)]
        if not reports:
            across, upwards = physics.SPEED_SIGMA_MPS[walk.node.role]
            velocity = Variable("velocity", name, keyframe)
            self.priors += [
                Linear(velocity, i, 0.0, s, SURE) for i, s in enumerate((across, across, upwards))
            ]
            return
        unit = Variable("unit", name, keyframe)
        turn = initial_turn(walk.node.heading_rad, reports[0].heading_rad)
        spread = min(
            max(walk.node.heading_sigma_rad or physics.HEADING_SIGMA_RAD, physics.HEADING_FLOOR_RAD), np.pi
        )
        sigmas = (spread, physics.BIAS_SIGMA_RADPS, physics.SCALE_SIGMA)
        self.priors += [
            Linear(unit, i, v, s, SURE) for i, (v, s) in enumerate(zip((turn, 0.0, 0.0), sigmas, strict=True))
        ]
        for second, told in walk.turns:
            at = int(np.clip(np.searchsorted(self.epochs, second, side="right") - 1, walk.first, walk.last))
            self.priors.append(told._replace(variable=Variable("unit", name, float(at))))

    def _entry(
        self, node: NodeState, reports: Sequence[Displacement], readings: Sequence[AnyReading]
    ) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Where a moving node entered, and how sure that is: told, or at the base, or anywhere."""
        placed = next((r for r in readings if isinstance(r, Node | Position) and _places(r, node.node)), None)
        first_report = reports[0].t if reports else math.inf
        if isinstance(placed, Node) and placed.position_m is not None and placed.t <= first_report:
            usual = physics.FIX_SIGMA_M[0] if node.role == "uav" else physics.SURVEY_SIGMA_M
            sigma = max(placed.sigma_m or usual, physics.SIGMA_FLOOR_M)
            return placed.position_m, (sigma,) * 3
        if reports and (placed is None or placed.t > first_report):
            return self.pace.state.base_place(), physics.ENTRY_SIGMA_M
        return (0.0, 0.0, 0.0), (FAR_M,) * 3

    def _begin_lasting(self, lasting: Sequence[Variable], readings: Sequence[AnyReading]) -> None:
        state = self.pace.state
        for name, blocks in self.standing.items():
            found = state.place(state.nodes[name])
            told = next((r for r in readings if isinstance(r, Node) and _places(r, name)), None)
            for since, variable in blocks:
                start = self.starts[variable]
                self.x[start : start + 3] = found
                if since != -math.inf:
                    continue
                where, sigma = found.tolist(), [FAR_M, FAR_M, physics.UNDECIDED_UP_SIGMA_M]
                if told is not None and told.position_m is not None:
                    usual = physics.ANCHOR_SIGMA_M if told.role == "anchor" else physics.SURVEY_SIGMA_M
                    where, sigma = (
                        list(told.position_m),
                        [max(told.sigma_m or usual, physics.SIGMA_FLOOR_M)] * 3,
                    )
                self.priors += [Linear(variable, i, where[i], sigma[i], SURE) for i in range(3)]
        for variable in lasting:
            if variable.kind not in ("range", "rssi"):
                continue
            start = self.starts[variable]
            self.x[start : start + 2] = state.graph.value(variable)
            bias = physics.RANGE_BIAS_SIGMA_M.get(variable.owner, physics.RANGE_BIAS_OTHER_SIGMA_M)
            values = (
                ((0.0, physics.RANGE_SCALE_SIGMA), (0.0, bias))
                if variable.kind == "range"
                else (
                    (physics.RSSI_POWER_DBM, physics.RSSI_POWER_SIGMA_DB),
                    (physics.RSSI_EXPONENT, physics.RSSI_EXPONENT_SIGMA),
                )
            )
            self.priors += [Linear(variable, i, v, s, SURE) for i, (v, s) in enumerate(values)]


def _places(reading: Node | Position, name: str) -> bool:
    return reading.node == name and (isinstance(reading, Position) or reading.position_m is not None)
