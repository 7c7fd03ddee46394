"""Radios whose ranges count as what they were reported as, and those that are a technology by themselves."""

from collections.abc import Collection

import numpy as np

from estimator.fusion import physics
from estimator.fusion.entering.technologies import technology_states
from estimator.fusion.learned.calibration import bias_sigma_m, uncalibrated
from estimator.fusion.learned.delays import Radio, delayed_radio, reported_as, source_of
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.variable import BIAS
from estimator.smoothing.learning.radios import Delay
from estimator.smoothing.problem.newton import Problem

REGAINED = 0.5
"""A radio is trusted again where its ranges make a delay less likely by this than it is of any radio."""


def distrust(state: FusionState, radios: list[Delay]) -> None:
    """Let the ranges of radios be technologies by themselves, in the ledger and from now on.

    Args:
        state: the fusion, changed in place.
        radios: which.
    """
    if not radios:
        return
    for (technology, name), _, bias_m, *_ in radios:
        state.delayed[technology, name] = None
        text = (
            f"{technology} ranges of {name} are off by {bias_m:+.1f} m: its antenna delay is not calibrated"
        )
        if _was_dropped(state.nodes[name]):
            text += ", or it lies elsewhere than it did"
        state.say("outlier", state.newest_t, name, text)
    _tell_apart(state)
    state.due = True


def trust_dropped(state: FusionState) -> set[Radio]:
    """Take back that radios are off which stand where nobody has told: a kick may have seemed a delay.

    Args:
        state: the fusion, changed in place; nothing has left its window.

    Returns:
        These radios.
    """
    dropped = {radio for radio in state.delayed if _was_dropped(state.nodes[radio[1]])}
    _trust(state, dropped)
    return dropped


def trust_moved(state: FusionState, name: str) -> None:
    """Take back that radios of a node are off which lies elsewhere than it did: that has seemed a delay.

    Args:
        state: the fusion, changed in place.
        name: of the node.
    """
    _trust(state, {radio for radio in state.delayed if radio[1] == name})


def trust_regained(state: FusionState, problem: Problem, x: Array, border: Array) -> None:
    """Take back that radios are off whose ranges by themselves say that they are not.

    While a map was bent, a radio may have seemed to be off that never was (decision 0101).

    Args:
        state: the fusion, changed in place.
        problem: of the window.
        x: its solution, flat.
        border: covariance of what lasts.
    """
    size, regained = problem.layout.length * problem.layout.width, set[Radio]()
    for (kind, number), start in problem.layout.technologies.items():
        source = state.sources[number]
        radio = delayed_radio(source) if kind == "range" else None
        if radio not in state.delayed:
            continue
        wide, usual, at = bias_sigma_m(source), bias_sigma_m(reported_as(source)), start + BIAS
        bias_m, variance_m2 = float(x[size + at]), float(border[at, at])
        if uncalibrated(wide, bias_m, variance_m2, usual, wide, physics.DELAYED) < REGAINED * physics.DELAYED:
            regained.add(radio)
    _trust(state, regained)
    state.due = state.due or bool(regained)


def _was_dropped(node: NodeState) -> bool:
    """Whether it stands where nobody has told."""
    return not node.moving and node.role not in ("base", "anchor") and node.absolute.believed_m is None


def _trust(state: FusionState, radios: Collection[Radio]) -> None:
    if radios:
        state.delayed = {radio: None for radio in state.delayed if radio not in radios}
        _tell_apart(state)


def _tell_apart(state: FusionState) -> None:
    """Let the ledger's ranges count as what they do by the radios that are not trusted now."""
    pairs = state.ledger.table("pairs").copy()
    ranges = np.flatnonzero(pairs[:, 1] == RANGE)
    for source, a, b in np.unique(pairs[ranges][:, [6, 2, 3]].astype(np.intp), axis=0).tolist():
        was = state.sources[source]
        name = source_of(reported_as(was), state.owners[a], state.owners[b], state.delayed)
        if name == was:
            continue
        if was in state.noise:
            state.noise.setdefault(name, state.noise[was])
        if was in state.calibrations:
            state.calibrations.setdefault(name, state.calibrations[was])
        if was in state.bodies:
            state.bodies.setdefault(name, state.bodies[was])
        mine = (pairs[:, 1] == RANGE) & (pairs[:, [6, 2, 3]] == (source, a, b)).all(axis=1)
        pairs[mine, 6] = state.source(name)
        technology_states(state, name)
    state.ledger.replace("pairs", pairs)
