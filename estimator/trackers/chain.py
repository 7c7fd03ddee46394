"""A chain of the filter's states, tick after tick, that late readings roll back."""

from bisect import bisect_left
from collections.abc import Mapping, Sequence

import numpy as np

from estimator.estimate import Notice
from estimator.fusion.canonical_order import end_of_tick, in_order
from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.inertial.samples import AnyFolded
from estimator.smoothing.images.flip_ambiguity import HURRIED, LIVE, Effort
from estimator.smoothing.window import JOLT_M, solve_if_due, solve_now

AGES_S, SPACINGS_S = (4.0, 16.0), (0.0, 4.0, 16.0)
"""Up to each age, and beyond the last, checkpoints are kept so far apart: a reading late by x is folded anew
over about x, no more."""

MOST = 16
"""Checkpoints from which on they are thinned: up to five more than are left then, so not after each tick."""

Checkpoint = tuple[int, FusionState]


class Chain:
    """States of the filter, each folded from the one before it and the readings of its own tick.

    Args:
        checkpoints: ticks with the states after them, at least one, in order.
        effort: how much its windows ask of images.

    Attributes:
        checkpoints: those that are kept.
        ahead: ticks that were folded before their turn, with the states after them and what was noticed.
    """

    def __init__(self, checkpoints: Sequence[Checkpoint], effort: Effort = LIVE) -> None:
        self.checkpoints = list(checkpoints)
        self.ahead: list[tuple[int, FusionState, list[Notice]]] = []
        self._effort = effort

    @property
    def folded(self) -> int:
        """The newest tick that is folded."""
        return self.checkpoints[-1][0]

    @property
    def state(self) -> FusionState:
        """The state after it; not to be changed."""
        return self.checkpoints[-1][1]

    def ends(self) -> list[Checkpoint]:
        """The oldest and the newest checkpoint: those between are folded anew when they are needed."""
        return self.checkpoints if len(self.checkpoints) < 3 else [self.checkpoints[0], self.checkpoints[-1]]

    def roll_back(self, tick: int) -> None:
        """Forget the states that readings of a tick would change."""
        while self.ahead and self.ahead[-1][0] >= tick:
            self.ahead.pop()
        while self.checkpoints[-1][0] >= tick:
            self.checkpoints.pop()

    def extend(
        self,
        ticks: Sequence[int],
        readings: Mapping[int, Sequence[AnyFolded]],
        notices: dict[int, list[Notice]],
    ) -> None:
        """Fold ticks, and solve the window wherever it is due.

        Args:
            ticks: those after the newest one that is folded, in order.
            readings: of each tick.
            notices: what was noticed in each tick; takes those of these ticks.
        """
        for tick in ticks:
            if not self.ahead:
                self.fold_ahead(tick, readings[tick])
            _, after, notices[tick] = self.ahead.pop(0)
            self.checkpoints.append((tick, after))
            if len(self.checkpoints) > MOST:
                self._thin()

    def fold_ahead(self, tick: int, readings: Sequence[AnyFolded]) -> None:
        """Fold a tick before its turn, and solve the window where it is due.

        Args:
            tick: the one after the newest one that is folded, before its turn or not.
            readings: of it.
        """
        before = self.ahead[-1][1] if self.ahead else self.state
        after = before.copy()
        fold_tick(after, end_of_tick(tick), in_order(readings))
        after.bent_m = max(after.bent_m, found_m(before, after))
        solve_if_due(after, end_of_tick(tick), effort=self._effort)
        self.ahead.append((tick, after, list(after.notices)))

    def _thin(self) -> None:
        """Leave checkpoints out as they age; the two newest always stay."""
        now, before = end_of_tick(self.folded), (0.0, 0.0)
        thinned: list[Checkpoint] = []
        for i, checkpoint in enumerate(self.checkpoints[:-2]):
            end = end_of_tick(checkpoint[0])
            spacing = SPACINGS_S[bisect_left(AGES_S, now - end)]
            if spacing == 0.0:
                thinned += self.checkpoints[i:]
                break
            bucket = (spacing, end // spacing)
            # The oldest of each bucket stays, so that what has grown old enough to be thinned is not lost
            # again.
            if bucket != before:
                before = bucket
                thinned.append(checkpoint)
        else:
            thinned += self.checkpoints[-2:]
        self.checkpoints = thinned


def found_m(before: FusionState, after: FusionState) -> float:
    """How far a tick's readings have moved somebody of whom it was not known where he was (m).

    Two ranges leave two places. The filter goes to the nearer one, and only a window looks at the other.

    Args:
        before: the state before the tick.
        after: the state after it.
    """
    farthest_m, here, there = 0.0, after.graph.reference, before.graph.reference
    for name, node in after.nodes.items():
        if node.mode != "unit":
            continue
        was = before.nodes.get(name)
        if was is None or was.mode != "unit":
            continue
        at, now = before.graph.starts[was.position], after.graph.starts[node.position]
        east, north = float(here[now] - there[at]), float(here[now + 1] - there[at + 1])
        walked_m = node.way_m - was.way_m
        # No way is longer than both its sides.
        if abs(east) + abs(north) - walked_m <= JOLT_M:
            continue
        off_m = float(np.hypot(east, north)) - walked_m
        if off_m > max(JOLT_M, farthest_m):
            unsure_m2 = np.trace(before.graph.covariance()[at : at + 2, at : at + 2])
            farthest_m = off_m if unsure_m2 > JOLT_M**2 else farthest_m
    return farthest_m


def hurried(
    before: Chain,
    ticks: Sequence[int],
    readings: Mapping[int, Sequence[AnyFolded]],
    notices: dict[int, list[Notice]],
) -> Chain:
    """A chain that goes on after ticks which were folded with one solution of the window, after the last.

    Args:
        before: the chain before them.
        ticks: they are, in order.
        readings: of each tick.
        notices: what was noticed in each tick; takes those of these ticks.
    """
    if not ticks:
        return Chain(before.checkpoints[-1:], HURRIED)
    state = before.state.copy()
    for tick in ticks:
        fold_tick(state, end_of_tick(tick), in_order(readings[tick]))
        notices[tick] = list(state.notices)
    solve_now(state, end_of_tick(ticks[-1]), HURRIED)
    notices[ticks[-1]] = list(state.notices)
    return Chain([(ticks[-1], state)], HURRIED)
