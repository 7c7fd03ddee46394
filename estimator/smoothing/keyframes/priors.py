"""What is known beforehand of everything that enters inside a window."""

from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.entering.technologies import path_loss_prior, ranging_sigma
from estimator.fusion.memory.prior import Key
from estimator.graph.dense import Array, Indices
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import PLACES, STATES


class Priors(NamedTuple):
    """Independent priors of single numbers.

    Attributes:
        at: their flat columns, n.
        mean: n.
        information: one over their variances, n.
    """

    at: Indices
    mean: Array
    information: Array


def own_priors(layout: Layout, known: Collection[Key]) -> Priors:
    """Priors of what no earlier window knows: how nodes entered, what a unit and a technology usually are.

    Args:
        layout: of the window.
        known: the blocks that the window's prior tells of already.
    """
    state = layout.state
    at: list[int] = []
    mean: list[float] = []
    known_by: list[float] = []
    begins = state.ledger.table("begins")
    for i, walk in enumerate(layout.walks):
        before = ("free", walk.number) in known
        if ("walk", walk.number) in known or (before and walk.way is None):
            continue
        rows = begins[begins[:, 1] == walk.number]
        start = walk.first * layout.width + STATES * i
        entry, role = rows[0], "uav" if rows[0][3] else "responder"
        if not before:
            at += range(start, start + PLACES)
            mean += entry[4:7].tolist()
            known_by += (entry[7:10] ** -2.0).tolist()
        at += range(start + PLACES, start + STATES)
        if walk.way is None:
            across, upwards = physics.SPEED_SIGMA_MPS[role]
            mean += [0.0, 0.0, 0.0]
            known_by += [across**-2, across**-2, upwards**-2]
        else:
            unit = rows[rows[:, 2] == 1.0][-1]
            mean += [float(unit[10]), 0.0, 0.0]
            bias = state.bias_sigma_radps(walk.node)
            known_by += [float(unit[11]) ** -2, bias**-2, 1.0 / scale_variance(layout, i)]
    size = layout.length * layout.width
    for row in state.ledger.table("stands"):
        number = int(row[1])
        if ("stand", number) not in known:
            start = size + layout.stands[number]
            at += range(start, start + 3)
            mean += row[2:5].tolist()
            known_by += (row[5:8] ** -2.0).tolist()
    for key, start in layout.technologies.items():
        if key in known:
            continue
        if key[0] == "altimeter":
            at.append(size + start)
            off_m, sigma_m = state.altimeters[state.sources[key[1]]]
            mean.append(off_m)
            known_by.append(sigma_m**-2)
            continue
        if key[0] == "receiver":
            receiver = state.receivers[state.sources[key[1]]]
            at += range(size + start, size + start + 4)
            mean += receiver.mean.tolist()
            known_by += [sigma**-2 for sigma in receiver.sigma]
            continue
        at += range(size + start, size + start + 3)
        if key[0] == "range":
            told, sigma = (0.0, 0.0, 0.0), ranging_sigma(state, state.sources[key[1]])
        else:
            told, sigma = path_loss_prior(state, state.sources[key[1]])
        mean += told
        known_by += [each**-2 for each in sigma]
    return Priors(np.array(at, dtype=np.intp), np.array(mean), np.array(known_by, dtype=np.float64))


def scale_variance(layout: Layout, index: int) -> float:
    """Variance of the prior of the scale of a unit's steps where its walk begins, by the walk's index."""
    walk = layout.walks[index]
    # Who crawls from the first on begins with the scale of a crawl.
    crawls = 0.0 if walk.way is None else walk.way.renewed2(float(layout.times[walk.first, index]))
    return crawls or layout.state.scale_sigma(walk.node) ** 2
