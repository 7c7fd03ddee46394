"""What walls do to all readings between a crew and an anchor, as a vehicle is: one number for each minute.

Floors, walls and the building's shell lie between everybody of a crew inside and the vehicle outside: all
their powers are too weak alike (decision 0123), and all their ranges too long (decision 0125). Taken for
errors of each link, that turns the map until it fits. Both are called losses here.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.memory.prior import Key
from estimator.fusion.memory.state import FusionState
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array

STEP_S = 60.0
STEPS = 20
"""So many steps has a whole incident at most."""
KEPT_S = 600.0
"""What was lost so long ago tells nothing of what is lost."""
NODES, SECONDS = 1 << 15, 1 << 32
"""There are fewer nodes in any ledger, and epochs are smaller."""
KINDS = max(RANGE, RSSI) + 1
"""Of the readings that lose something: each has losses of its own."""
EVERYONE = NODES - 1
"""Whom a crew's readings lose something to in what they lose to all radios alike."""


class Losses(NamedTuple):
    """Which ranges and powers lose what.

    Attributes:
        crew: the row in `columns` of each number in the ledger; −1: it is no bearer of a unit.
        radio: the column there of each number; −1: it is no anchor.
        since_s: epoch at which the first step begins (s).
        step_s: how long each lasts (s).
        columns: of the border, of what each kind of readings of each crew loses to each radio, and at last to
            all alike, in each step, kinds × crews × (radios + 1) × steps; −1: there are none of them.
    """

    crew: Integers
    radio: Integers
    since_s: float
    step_s: float
    columns: Integers


class Loss(NamedTuple):
    """One of them.

    Attributes:
        column: of the border.
        kind: of the readings that lose it.
        since_s: epoch at which its step begins (s).
        before: the block of what the same crew lost to the same radio before it; None: of nothing before.
        common: the block of what the crew loses to all radios in that step; None: this is it.
    """

    column: int
    kind: int
    since_s: float
    before: Key | None
    common: Key | None


def losses_of(
    state: FusionState, bearers: Sequence[int], grid: Array, carried: Sequence[Key], start: int
) -> tuple[Losses, dict[Key, Loss]]:
    """What is lost in a window.

    Args:
        state: the fusion.
        bearers: numbers of those in it who wear units.
        grid: epochs of its keyframes, ascending (s).
        carried: the blocks of what is known from before.
        start: the first free column of its border.

    Returns:
        The losses, and each of their blocks.
    """
    step_s, since_t = STEP_S, float(grid[0])
    if state.ledger.complete:
        step_s *= max(math.ceil((float(grid[-1]) - since_t) / STEPS / STEP_S), 1)
    owners = state.owners
    crew, radio = np.full(len(owners) + 1, -1), np.full(len(owners) + 1, -1)
    # Those of whom nobody has told a crew are one.
    names = {number: state.nodes[owners[number]].crew for number in bearers}
    leaders = {name: number for number, name in sorted(names.items(), reverse=True)}
    crews = sorted(leaders.values())
    for number, name in names.items():
        crew[number] = crews.index(leaders[name])
    radios = [n.index for n in state.nodes.values() if n.role == "anchor" and n.index >= 0]
    radio[radios] = np.arange(len(radios))
    others = [*radios, EVERYONE]
    known = [parts_of(number) for kind, number in carried if kind == "loss"]
    since_s = min([since_t // step_s * step_s, *(since for *_, since in known)])
    # Most incidents have no anchor: then nobody is asked whom he hears.
    steps = int((float(grid[-1]) - since_s) // step_s) + 1 if radios else 0
    columns = np.full((KINDS, len(crews), len(others), steps), -1)
    found = Losses(crew, radio, since_s, step_s, columns)
    if columns.size:
        mark_heard(state.ledger.table("pairs"), since_t, found)
    for kind, leader, other, since in known if radios else ():
        if leader in crews and other in others:
            step = int((since - since_s) // step_s)
            columns[kind, crews.index(leader), others.index(other), step] = 0
    columns[:, :, -1] = columns.max(axis=2)
    at = np.argwhere(columns >= 0)
    columns[tuple(at.T)] = start + np.arange(len(at))
    blocks: dict[Key, Loss] = {}
    newest: dict[tuple[int, int, int], Key] = {}
    for column, (kind, row, other, step) in enumerate(at.tolist()):
        begins_s, before = since_s + step * step_s, newest.get((kind, row, other))
        key, common = (_key(kind, crews[row], whom, begins_s) for whom in (others[other], EVERYONE))
        blocks[key] = Loss(start + column, kind, begins_s, before, None if key == common else common)
        newest[kind, row, other] = key
    return found, blocks


def _key(kind: int, leader: int, radio: int, since_s: float) -> Key:
    return "loss", ((leader * KINDS + kind) * NODES + radio) * SECONDS + int(since_s)


def parts_of(number: int) -> tuple[int, int, int, float]:
    """Of the number of a loss: the kind, the crew's first node, the radio, and when its step begins (s)."""
    pair, since_s = divmod(number, SECONDS)
    crew, radio = divmod(pair, NODES)
    leader, kind = divmod(crew, KINDS)
    return kind, leader, radio, float(since_s)


def going_on(lost: Mapping[Key, Loss], cut_t: float) -> list[Key]:
    """The losses that are asked for after a cut (s): those since, and the newest that others follow."""
    followed = {one.before for one in lost.values()}
    kept = {
        key
        for key, one in lost.items()
        if one.since_s + STEP_S > cut_t or (key not in followed and one.since_s + KEPT_S > cut_t)
    }
    kept |= {common for key in kept if (common := lost[key].common) is not None}
    return [key for key in lost if key in kept]


@njit(cache=True)
def mark_heard(pairs: Array, since_t: float, losses: Losses) -> None:
    """Mark who hears whom, and by what kind of readings.

    Args:
        pairs: rows of the ledger, m × 11.
        since_t: from which epoch on (s).
        losses: whose columns take 0 where they do.
    """
    for i in range(len(pairs)):
        if pairs[i, 0] >= since_t:
            kind, crew, radio, step = place_of(losses, pairs[i])
            if kind >= 0:
                losses.columns[kind, crew, radio, step] = 0


@njit(cache=True)
def place_of(losses: Losses, pair: Array) -> tuple[int, int, int, int]:
    """Where in `Losses.columns` what a pair, 11, has lost is; −1: nowhere."""
    kind = int(pair[1])
    a, b, step = int(pair[2]), int(pair[3]), int((pair[0] - losses.since_s) // losses.step_s)
    if kind < KINDS and 0 <= step < losses.columns.shape[3]:
        if losses.crew[a] >= 0 and losses.radio[b] >= 0:
            return kind, losses.crew[a], losses.radio[b], step
        if losses.crew[b] >= 0 and losses.radio[a] >= 0:
            return kind, losses.crew[b], losses.radio[a], step
    return -1, -1, -1, -1


@njit(cache=True)
def loss_column(losses: Losses, pair: Array) -> int:
    """Which column of the border what a pair, 11, has lost is; −1: none."""
    kind, crew, radio, step = place_of(losses, pair)
    return losses.columns[kind, crew, radio, step] if kind >= 0 else -1
