"""A window of an incident as one problem: who moves, who stands, how the numbers are laid out."""

from collections.abc import Sequence
from copy import copy
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np

from estimator.fusion.memory.ledger import RANGE, UNTOLD_POWER, own_rows
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.prior import Key, Prior
from estimator.fusion.memory.state import FusionState
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.graph.variable import DIMENSION, TECHNOLOGIES, Variable
from estimator.smoothing.keyframes.displacement_sums import Way
from estimator.smoothing.keyframes.levelled_ways import levelled
from estimator.smoothing.keyframes.losses import losses_of
from estimator.smoothing.keyframes.walks import HEADING, STATES


class Walk(NamedTuple):
    """One moving node in the window.

    Attributes:
        number: of the node in the ledger.
        node: as it is now.
        first: its first keyframe.
        last: its last one.
        way: sums of its displacements; None: it has no PDR unit.
        begins: it begins inside the window: its prior is its own, not the window's.
    """

    number: int
    node: NodeState
    first: int
    last: int
    way: Way | None
    begins: bool


class Layout:
    """Keyframes of all that moves, and what stands beside them.

    Attributes:
        state: the fusion that the window belongs to.
        since_t: epoch from which on it reaches (s).
        grid: epochs of the keyframes, k, ascending (s).
        walks: the moving nodes, each with six columns of every keyframe.
        spans: first and last keyframe of each walk, walks × 2.
        times: the epoch of each walk at each keyframe, k × walks: the grid's, inside its own life; at the
            first one, what the prior tells of.
        width: columns of a keyframe.
        stands: first column of each standing node in the border, by its number.
        technologies: first column of each technology in the border, by kind and number.
        losses: what powers between crews and anchors lose.
        lost: each loss in the border, by kind and number.
        border: columns of the border.
        landmarks: numbers of those whose places are told from outside.
    """

    def __init__(
        self, state: FusionState, since_t: float, spacing_s: float, prior: Prior | None = None
    ) -> None:
        self.state = state
        self.since_t = since_t
        nodes = {node.index: node for node in state.lives()}
        self.landmarks = frozenset(number for number, node in nodes.items() if node.landmark)
        begins = state.ledger.table("begins")
        alive: dict[int, tuple[float, bool]] = {}
        for row in begins:
            number = int(row[1])
            unit = bool(row[2]) or alive.get(number, (0.0, False))[1]
            alive[number] = alive.get(number, (row[0], False))[0], unit
        ends = {n: max(nodes[n].pose_t, t) for n, (t, _) in alive.items()}
        kept = [n for n in alive if nodes[n].moving or (ends[n] > since_t)]
        until = max((ends[n] for n in kept), default=since_t + 1.0)
        inner = np.arange(np.floor(since_t / spacing_s) + 1.0, np.ceil(until / spacing_s)) * spacing_s
        inner = inner[(inner > since_t + 1e-3) & (inner < until - 1e-3)]
        self.grid: Array = np.concatenate([[since_t], inner, [max(until, since_t + 1e-3)]])
        self.walks = [self._walk(nodes[n], *alive[n], ends[n]) for n in kept]
        self.spans = spans_of(self.walks)
        self.column_of = {w.number: STATES * i for i, w in enumerate(self.walks)}
        # Of who has been silent since before the window nothing is known inside it: he is where he was then.
        lives = np.array([[min(max(alive[n][0], since_t), ends[n]), ends[n]] for n in kept]).reshape(-1, 2)
        self.times: Array = np.clip(self.grid[:, None], lives[:, 0], lives[:, 1])
        for i, walk in enumerate(self.walks):
            known_t = None if prior is None else prior.epochs.get(walk.number)
            if known_t is not None:
                self.times[0, i] = min(self.times[0, i], known_t)
        self.width = STATES * len(self.walks)
        self._lay_border(() if prior is None else prior.keys)

    def _walk(self, node: NodeState, begin_t: float, unit: bool, end_t: float) -> Walk:
        start = min(max(begin_t, self.since_t), end_t)
        first = max(int(np.searchsorted(self.grid, start, side="right")) - 1, 0)
        last = len(self.grid) - 1
        if not node.moving:
            last = min(max(int(np.searchsorted(self.grid, end_t, side="left")), first), last)
        way = None
        if unit:
            mine = own_rows(self.state.ledger.table("steps"), node.index)
            mine = levelled(node, mine)
            way = Way(float(mine[0, 2]) if len(mine) else start, mine, node.walk_factors)
        return Walk(node.index, node, first, last, way, begin_t >= self.since_t)

    def _lay_border(self, carried: Sequence[Key]) -> None:
        self.stands: dict[int, int] = {}
        self.technologies: dict[Key, int] = {}
        start = 0
        for row in self.state.ledger.table("stands"):
            if int(row[1]) not in self.stands:
                self.stands[int(row[1])] = start
                start += 3
        for variable in self.state.graph.starts:
            if variable.kind in TECHNOLOGIES:
                self.technologies[technology_key(self.state, variable)] = start
                start += DIMENSION[variable.kind]
        bearers = [walk.number for walk in self.walks if walk.way is not None]
        self.losses, self.lost = losses_of(self.state, bearers, self.grid, carried, start)
        self.border = start + len(self.lost)

    def part(self, walks: Sequence[int], until: int) -> Self:
        """Some of its walks up to some keyframe, beside all of its border.

        Args:
            walks: their indices, ascending; each begins before that keyframe.
            until: the keyframe.
        """
        other = copy(self)
        vars(other).pop("_thought", None)
        other.grid, other.times = self.grid[: until + 1], self.times[: until + 1, list(walks)]
        some = [self.walks[i] for i in walks]
        other.walks = [walk._replace(last=min(walk.last, until)) for walk in some]
        other.spans = spans_of(other.walks)
        other.column_of = {walk.number: STATES * i for i, walk in enumerate(some)}
        other.width = STATES * len(some)
        return other

    def headings(self) -> Integers:
        """Which of the flat unknowns are headings of units, walk after walk."""
        each = [
            self.width * np.arange(walk.first, walk.last + 1) + STATES * i + HEADING
            for i, walk in enumerate(self.walks)
            if walk.way is not None
        ]
        return np.concatenate([np.zeros(0, dtype=np.int64), *each])

    @property
    def ranges_lose(self) -> bool:
        """Whether ranges between a crew and an anchor are asked what they lose."""
        return any(loss.kind == RANGE for loss in self.lost.values())

    @property
    def length(self) -> int:
        """Number of keyframes."""
        return len(self.grid)

    def start(self) -> Array:
        """The unknowns as they were thought to be when first asked: keyframes, then the border, flat."""
        return self._thought.copy()

    @cached_property
    def _thought(self) -> Array:
        x = np.zeros(self.length * self.width + self.border)
        keyframes = x[: self.length * self.width].reshape(self.length, self.width)
        poses = self.state.ledger.table("poses")
        for i, walk in enumerate(self.walks):
            mine = own_rows(poses, walk.number)
            other = (mine[:, 2] == 1.0) != (walk.way is not None)
            if other.any():
                mine = mine.copy()
                mine[other, 6:] = mine[~other][0, 6:] if not other.all() else 0.0
            if len(mine):
                alive = slice(walk.first, walk.last + 1)
                for c in range(STATES):
                    column = STATES * i + c
                    keyframes[alive, column] = np.interp(self.times[alive, i], mine[:, 0], mine[:, 3 + c])
        border = x[self.length * self.width :]
        stands = self.state.ledger.table("stands")
        for row in stands:
            number = int(row[1])
            node = self.state.life(number)
            current = node.index == number and (node.decided or node.place_m is not None)
            place = self.state.place(node) if current else row[2:5]
            border[self.stands[number] : self.stands[number] + 3] = place
        for variable in self.state.graph.starts:
            if variable.kind in TECHNOLOGIES:
                at = self.technologies[technology_key(self.state, variable)]
                border[at : at + DIMENSION[variable.kind]] = self.state.graph.value(variable)
        for (_, number), one in self.lost.items():
            usual = 0.0 if one.before is None else border[self.lost[one.before].column]
            border[one.column] = self.state.lost.get(number, usual)
        return x

    def states(self, x: Array, index: int) -> Array:
        """A walk's states at all keyframes in an estimate, k × 6: a view, by which it may be changed."""
        keyframes = x[: self.length * self.width].reshape(self.length, self.width)
        return keyframes[:, STATES * index : STATES * (index + 1)]

    def end_of(self, x: Array, index: int) -> tuple[Array, float]:
        """Where an estimate, flat, has a walk, by index, end: east, north (m), and when (s)."""
        last = self.walks[index].last
        return self.states(x, index)[last, :2], float(self.times[last, index])


def spans_of(walks: Sequence[Walk]) -> Integers:
    """First and last keyframe of each walk, walks × 2."""
    return np.array([(walk.first, walk.last) for walk in walks], dtype=np.int64).reshape(-1, 2)


def technology_key(state: FusionState, variable: Variable) -> Key:
    """The block of a technology's states, by number of its source."""
    name = UNTOLD_POWER + variable.owner if variable.kind == "rssi" else variable.owner
    return variable.kind, state.source(name)
