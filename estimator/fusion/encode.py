"""The fusion's state as bytes and back, exact to the last bit."""

import msgspec
import numpy as np

from estimator.fusion.nodes import Clone, NodeState, Sighting
from estimator.fusion.noise import LearnedNoise, Link
from estimator.fusion.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.variable import Variable
from estimator.measurements import AnyReading

ArrayRecord = tuple[list[int], bytes]


class FusionRecord(msgspec.Struct, frozen=True, array_like=True):
    """`FusionState` in plain values."""

    origin_wgs84: tuple[float, float, float] | None
    variables: list[Variable]
    arrays: tuple[ArrayRecord, ArrayRecord, ArrayRecord]
    nodes: list[NodeState]
    sightings: dict[str, tuple[Sighting, ...]]
    clones: dict[str, tuple[Clone, ...]]
    waiting: tuple[AnyReading, ...]
    noise: dict[str, LearnedNoise]
    links: dict[str, Link]
    reference_pa: float | None
    counts: dict[str, int]
    said: list[str]
    tried: dict[str, int]
    clone_step: dict[str, float]


def record_of(state: FusionState) -> FusionRecord:
    """The state's record; it shares nothing that changes."""
    matrix, vector, reference = state.graph.storage()
    return FusionRecord(
        state.origin_wgs84,
        list(state.graph.starts),
        (_record(matrix), _record(vector), _record(reference)),
        list(state.nodes.values()),
        dict(state.sightings),
        dict(state.clones),
        state.waiting,
        dict(state.noise),
        dict(state.links),
        state.reference_pa,
        dict(state.counts),
        list(state.said),
        dict(state.tried),
        dict(state.clone_step),
    )


def state_of(record: FusionRecord) -> FusionState:
    """The state that a record was made of."""
    state = FusionState(record.origin_wgs84)
    matrix, vector, reference = (_array(r) for r in record.arrays)
    state.graph = Kirchhoff.of(record.variables, matrix, vector, reference)
    state.nodes = {n.node: n for n in record.nodes}
    state.sightings, state.clones, state.waiting = record.sightings, record.clones, record.waiting
    state.noise, state.reference_pa, state.counts = record.noise, record.reference_pa, record.counts
    state.said, state.tried = dict.fromkeys(record.said), record.tried
    state.clone_step, state.links = record.clone_step, record.links
    return state


def _record(array: Array) -> ArrayRecord:
    return list(array.shape), array.tobytes()


def _array(record: ArrayRecord) -> Array:
    shape, content = record
    array: Array = np.frombuffer(content, dtype=np.float64).reshape(shape).copy()
    return array
