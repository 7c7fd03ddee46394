"""Parts of a window: some of its walks up to some keyframe, with all others held where they are.

What they say by themselves is told from a tenth of the readings, and at first from a minute of them.
"""

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.images import turned_about
from estimator.graph.dense import Array
from estimator.smoothing.images.flip_ambiguity import Flip
from estimator.smoothing.images.heading_images import drops_along, turns_whole
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.keyframes.walks import HEADING
from estimator.smoothing.problem.held_quadratic import HeldQuadratic, hold_quadratic
from estimator.smoothing.problem.newton import Problem

BEGINNING_S, LONGER = 60.0, 4.0
"""How much of a way is asked first of which heading it has; and how many times as much then."""


class Part:
    """A part of a window.

    Args:
        whole: the window.
        problem: that of the part.
        numbers: which of the window's it has.
        x: the window's estimate in which all others are held, flat.
    """

    def __init__(self, whole: Problem, problem: Problem, numbers: Unknowns, x: Array) -> None:
        self._whole, self.problem, self.numbers = whole, problem, numbers
        self._cost = problem.at(numbers.taken(x)).cost

    def more(self, x: Array) -> float:
        """What an estimate of the window, flat, costs more than the one in which all others are held.

        In log likelihood, and by the readings of the part.
        """
        return self.problem.at(self.numbers.taken(x)).cost - self._cost

    def led(self, x: Array, slacks_m: tuple[float, ...], iterations: int) -> Array:
        """The window's estimate that one leads to, flat: what comes after the part goes along with its end.

        Args:
            x: where to start, flat.
            slacks_m: see `Problem.solve`.
            iterations: at most so many steps.

        Raises:
            ValueError: it hangs in the air there.
        """
        layout, there = self._whole.layout, x.copy()
        found = self.problem.solve(self.numbers.taken(x), slacks_m, iterations)
        there[self.numbers.kept] = found.x
        for i in self.numbers.walks:
            walk = layout.walks[i]
            if walk.last > self.numbers.until:
                was, now = (layout.states(one, i)[self.numbers.until] for one in (x, there))
                by_rad = 0.0 if walk.way is None else float(now[HEADING] - was[HEADING])
                on = turned_about(was[:2], by_rad).through(was[:2], now[:2])
                rest = layout.states(there, i)[self.numbers.until + 1 : walk.last + 1]
                rest[:, :2] = on.of(rest[:, :2])
                if walk.way is not None:
                    rest[:, HEADING] += by_rad
                drops_along(layout, there, walk, on, self.numbers.until + 1)
        return there


class Parts:
    """All parts of a window that have been asked for.

    Args:
        problem: the window.
        x: its estimate in which all others are held, flat.
    """

    def __init__(self, problem: Problem, x: Array) -> None:
        self.problem, self.x = problem, x
        self._linear = problem.linearise(x)
        problem.rows.widen(x, self._linear.jacobian)
        self._weighted = problem.weigh(self._linear.residual)
        width, columns = problem.layout.width, problem.rows.columns
        self._border = np.where(columns >= width, columns - width, -1)
        self._found: dict[tuple[frozenset[int], int], Part] = {}

    def stages(self, flip: Flip) -> list[int]:
        """Up to which keyframes it is asked, one after the other, where an image of a way leads to.

        A part of the readings costs no more than all of them do: what they rule out, all do.
        """
        grid, flips = self.problem.layout.grid, [flip, *(one for _, one in flip.along)]
        found, span_s, last = list[int](), BEGINNING_S, len(grid) - 1
        since = max(one.since for one in flips)
        while all(turns_whole(one.image) for one in flips):
            until = int(np.searchsorted(grid, grid[since] + span_s))
            if until >= last:
                break
            found.append(until)
            span_s *= LONGER
        return [*found, last]

    def of(self, walks: Collection[int], until: int) -> Part:
        """A part.

        Args:
            walks: indices of its walks, each of which begins before its last keyframe.
            until: its last keyframe.
        """
        key = frozenset(walks), until
        if key not in self._found:
            numbers = Unknowns(self.problem.layout, walks, until)
            part = self.problem.part(numbers, self.x, *self._divided(numbers))
            self._found[key] = Part(self.problem, part, numbers, self.x)
        return self._found[key]

    def _divided(self, numbers: Unknowns) -> tuple[NDArray[np.bool_], HeldQuadratic]:
        """The rows of a part, and what those say of the border that do not tell of its walks.

        What tells of them later on is in neither: that costs no less than nothing.
        """
        layout, rows = self.problem.layout, self.problem.rows
        own = rows.of([layout.walks[i].number for i in numbers.walks])
        border = self.x[layout.length * layout.width :]
        others = np.flatnonzero(~own)
        readings = self._border, self._linear.jacobian, self._weighted
        left = hold_quadratic(others, rows.shadows.among(others), *readings, border)
        return own & (rows.slab <= numbers.until), left
