"""What radios have ranged lately to what stands, beside how their units have gone."""

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.memory.ledger import GIVEN, RANGE, UNSEEN
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.motion.silence import SILENT_S
from estimator.fusion.motion.unreliable_unit import is_contradicted
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.changes.short_tracks import Led, RangedUnit
from estimator.smoothing.changes.track_fit import RangedTrack
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

DISAGREEING = 0.75
"""Of ranges that agree with a way most are good ones."""
OUTLIER = 0.1
"""Probability of being good below which a range is one."""
LATELY_S = 20.0
WHOLE_S = 1e-3
"""Closer to a whole second is one: epochs told to a millisecond are so in one of a thousand."""
RANGES, RADIOS = 12, 2
"""So many ranges to so many that stand are needed to tell anything."""


class RecentRanges:
    """The ranges of a solved window, by the walks whose radios heard them.

    Args:
        problem: of the window.
        solved: its solution.

    Attributes:
        problem: see above.
        solved: see above.
        until_t: end of the window (s).
    """

    def __init__(self, problem: Problem, solved: Solution) -> None:
        self.problem, self.solved = problem, solved
        self.until_t = float(problem.layout.grid[-1])

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        return self.problem.rows.places(self.solved.x)

    @cached_property
    def _bodies(self) -> Array:
        return self.problem.rows.bodies(self.solved.x)

    @cached_property
    def _through(self) -> NDArray[np.bool_]:
        return self.problem.rows.through(self.solved.x)

    @cached_property
    def _ranges(self) -> tuple[Integers, Array, Integers, NDArray[np.bool_]]:
        """Those that are ranges: which, their epochs, both ends, and which ends stand."""
        rows = self.problem.rows
        ranges = np.flatnonzero(rows.pairs[:, 1] == RANGE)
        stands = np.column_stack(rows.standing)[ranges]
        return ranges, rows.t[ranges], rows.pairs[ranges, 2:4].astype(np.intp), stands

    @cached_property
    def enough(self) -> bool:
        """Whether there are as many as tell anything of any walk."""
        return int(np.count_nonzero(self.problem.rows.pairs[:, 1] == RANGE)) >= RANGES

    def ill(self, index: int, node: NodeState) -> bool:
        """Whether the ranges of a walk's radio and the steps of its unit seem to disagree.

        Args:
            index: of the walk.
            node: its node.
        """
        return is_contradicted(node) or self.disagree(index)

    def in_whole_seconds(self, index: int, late_s: float) -> bool:
        """Whether all ranges of a walk's radio are stamped at whole seconds.

        Args:
            index: of the walk.
            late_s: by how much they are put to earlier than they were stamped (s).
        """
        stamped = self.problem.rows.t[self._of(index, -np.inf, np.inf)[0]] + late_s
        off_s = np.abs(stamped - np.round(stamped))
        return len(stamped) >= RANGES and float(off_s.max()) < WHOLE_S

    def led_since(self, index: int, closely: bool = False) -> float:
        """From when on the unit of a walk has told all of its way (s).

        Args:
            index: of the walk.
            closely: nothing is left out that it may have gone, for however short a time.
        """
        layout = self.problem.layout
        steps = layout.state.ledger.table("steps")
        mine = steps[steps[:, 1] == layout.walks[index].number]
        if len(mine) == 0:
            return math.inf
        silent = mine[:, 0] - mine[:, 2] > SILENT_S
        if closely:
            silent |= mine[:, GIVEN] == UNSEEN
        return float(mine[silent, 0].max(initial=mine[0, 2]))

    def agree(self, index: int, since_t: float) -> float:
        """Share of the ranges of a walk's radio from an epoch on (s) that agree with it; 1 where none are."""
        mine, _ = self._of(index, since_t, np.inf)
        return float(self.solved.weighted.good[mine].mean()) if len(mine) else 1.0

    def disagree(self, index: int) -> bool:
        """Whether many of the newest ranges of a walk's radio are outliers."""
        return self.agree(index, self.until_t - LATELY_S) < DISAGREEING

    def heard(
        self,
        index: int,
        since_t: float,
        until_t: float,
        led: Led | None = None,
        strange: bool = False,
        radios: int = RADIOS,
    ) -> RangedUnit | None:
        """The ranges between a walk's radio and what stands; None: too few.

        Args:
            index: of the walk.
            since_t: from when on (s).
            until_t: until when (s).
            led: how its unit has gone, where the window does not know.
            strange: only those that are outliers.
            radios: to how many that stand there have to be any.
        """
        rows, way = self.problem.rows, self.problem.layout.walks[index].way
        if way is None:
            return None
        mine, first = self._of(index, since_t, until_t)
        if strange:
            odd = self.solved.weighted.good[mine] < OUTLIER
            mine, first = mine[odd], first[odd]
        numbers = rows.pairs[mine, 2:4].astype(np.intp)
        others = np.where(first, numbers[:, 1], numbers[:, 0])
        if len(mine) < RANGES or len(np.unique(others)) < radios:
            return None
        a, b = (place_m[mine] for place_m in self._places)
        off_m = np.where(first[:, None], a - b, b - a)
        there_m = np.where(first[:, None], b, a)[:, :2].copy()
        # A clock that is late looks like a body: what that has been taken for is asked about again.
        range_m = np.sqrt((off_m**2).sum(axis=1)) + self.solved.linear.residual[mine] + self._bodies[mine]
        t = rows.t[mine]

        def by_unit(at_t: Array) -> Array:
            return way.between(np.full(len(at_t), t[0]), at_t)[:, :2]

        told = off_m[:, 2].copy(), range_m, self._usual_m(mine), rows.noise[mine]
        return RangedUnit(t, RangedTrack(there_m, *told), led or by_unit)

    def _usual_m(self, mine: Integers) -> Array:
        """Standard deviation of ranges before anything was learned of them (m).

        Through floors it is what it is there.
        """
        rows = self.problem.rows
        total = rows.nominal[mine] ** 2
        white, common = (1.0 - physics.SHARED_NOISE) * total, physics.SHARED_NOISE * total
        now = white + rows.alike[mine] * common
        floor_m2 = np.where(self._through[mine], physics.FLOOR_SIGMA[0] ** 2, 0.0)
        return np.sqrt((now - common) * now / white + floor_m2)

    def _of(self, index: int, since_t: float, until_t: float) -> tuple[Integers, NDArray[np.bool_]]:
        """Which rows are ranges between a walk and what stands, and of which it is the first end."""
        ranges, t, numbers, stands = self._ranges
        recent, number = (t > since_t) & (t <= until_t), self.problem.layout.walks[index].number
        first = recent & (numbers[:, 0] == number) & stands[:, 1]
        mine = first | (recent & (numbers[:, 1] == number) & stands[:, 0])
        return ranges[mine], first[mine]
