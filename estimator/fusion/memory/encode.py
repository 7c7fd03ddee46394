"""The fusion's state as bytes and back, exact to the last bit."""

import msgspec

from estimator.fusion.learned.calibration import Calibration
from estimator.fusion.learned.delays import Radio, Suspicion
from estimator.fusion.learned.link_correlation import Links
from estimator.fusion.learned.noise import LearnedNoise
from estimator.fusion.learned.reach import Reach
from estimator.fusion.learned.receivers import Receiver
from estimator.fusion.learned.told_places import MistoldPlace
from estimator.fusion.memory.hearing import Listener
from estimator.fusion.memory.ledger import COLUMNS
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.prior import Key, Prior
from estimator.fusion.memory.state import AnyHeld, FusionState
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.record import ArrayRecord, pack, unpack
from estimator.graph.variable import Variable
from estimator.inertial.record import NavigationRecord, navigation_of
from estimator.inertial.record import record_of as navigation_record_of
from estimator.measurements.displacement import Awaited
from estimator.measurements.node import Node


class PriorRecord(msgspec.Struct, frozen=True, array_like=True):
    """`Prior` in plain values."""

    keys: list[Key]
    arrays: tuple[ArrayRecord, ArrayRecord, ArrayRecord]
    epochs: dict[int, float]


class FusionRecord(msgspec.Struct, frozen=True, array_like=True):
    """`FusionState` in plain values."""

    origin_wgs84: tuple[float, float, float] | None
    variables: list[Variable]
    arrays: tuple[ArrayRecord, ArrayRecord, ArrayRecord]
    nodes: list[NodeState]
    ended: list[NodeState]
    called: dict[str, Node]
    sightings: dict[str, int]
    waiting: tuple[AnyHeld, ...]
    awaited: dict[str, Awaited]
    noise: dict[str, LearnedNoise]
    links: tuple[list[tuple[str, str, str]], ArrayRecord]
    reference: tuple[float, float] | None
    counts: dict[str, int]
    said: list[str]
    tried: dict[str, int]
    tables: dict[str, ArrayRecord]
    owners: tuple[str, ...]
    sources: tuple[str, ...]
    newest_t: float
    due: bool
    astray_t: float | None
    suspected: bool
    exposed: bool
    begun_t: float | None
    entered_t: float | None
    refreshed_t: float
    window_t: float | None
    prior: PriorRecord | None
    calibrations: dict[str, Calibration]
    bodies: dict[str, Calibration]
    bent_m: float
    level_cost: float
    navigations: dict[str, NavigationRecord]
    delayed: list[Radio]
    suspects: list[tuple[Radio, Suspicion]]
    delays_t: float
    mistold: dict[str, MistoldPlace]
    altimeters: dict[str, tuple[float, float]]
    receivers: dict[str, Receiver]
    lost: dict[int, float]
    clocks: dict[str, float]
    reach: Reach
    listeners: dict[str, Listener]


def record_of(state: FusionState) -> FusionRecord:
    """The state's record; it shares nothing that changes."""
    matrix, vector, reference = state.graph.storage()
    prior = state.prior
    return FusionRecord(
        state.origin_wgs84,
        list(state.graph.starts),
        (pack(matrix), pack(vector), pack(reference)),
        list(state.nodes.values()),
        list(state.ended.values()),
        dict(state.called),
        dict(state.sightings),
        state.waiting,
        dict(state.awaited),
        dict(state.noise),
        (list(state.links.numbers), pack(state.links.table)),
        state.reference,
        dict(state.counts),
        list(state.said),
        dict(state.tried),
        {name: pack(state.ledger.table(name)) for name in COLUMNS},
        state.owners,
        state.sources,
        state.newest_t,
        state.due,
        state.astray_t,
        state.suspected,
        state.exposed,
        state.begun_t,
        state.entered_t,
        state.refreshed_t,
        state.window_t,
        None
        if prior is None
        else PriorRecord(
            list(prior.keys),
            (pack(prior.matrix), pack(prior.vector), pack(prior.reference)),
            dict(prior.epochs),
        ),
        dict(state.calibrations),
        dict(state.bodies),
        state.bent_m,
        state.level_cost,
        {name: navigation_record_of(known) for name, known in state.navigations.items()},
        list(state.delayed),
        list(state.suspects.items()),
        state.delays_t,
        dict(state.mistold),
        dict(state.altimeters),
        dict(state.receivers),
        dict(state.lost),
        dict(state.clocks),
        state.reach,
        dict(state.listeners),
    )


def state_of(record: FusionRecord) -> FusionState:
    """The state that a record was made of."""
    state = FusionState(record.origin_wgs84)
    matrix, vector, reference = (unpack(r) for r in record.arrays)
    state.graph = Kirchhoff.of(record.variables, matrix, vector, reference)
    state.nodes = {n.node: n for n in record.nodes}
    state.ended, state.called = {n.index: n for n in record.ended}, record.called
    state.sightings, state.waiting, state.awaited = record.sightings, record.waiting, record.awaited
    state.noise, state.reference, state.counts = record.noise, record.reference, record.counts
    state.said, state.tried = dict.fromkeys(record.said), record.tried
    links, newest = record.links
    state.links = Links({link: number for number, link in enumerate(links)}, unpack(newest))
    state.owners, state.sources = record.owners, record.sources
    for name in COLUMNS:
        state.ledger.replace(name, unpack(record.tables[name]))
    state.newest_t, state.due, state.begun_t = record.newest_t, record.due, record.begun_t
    state.astray_t = record.astray_t
    state.suspected, state.exposed = record.suspected, record.exposed
    state.entered_t, state.refreshed_t, state.window_t = record.entered_t, record.refreshed_t, record.window_t
    state.calibrations, state.bent_m = record.calibrations, record.bent_m
    state.bodies = record.bodies
    state.level_cost = record.level_cost
    state.navigations = {name: navigation_of(known) for name, known in record.navigations.items()}
    state.delayed, state.delays_t = dict.fromkeys(record.delayed), record.delays_t
    state.suspects, state.mistold = dict(record.suspects), record.mistold
    state.altimeters = dict(record.altimeters)
    state.receivers, state.clocks = dict(record.receivers), dict(record.clocks)
    state.lost = dict(record.lost)
    state.reach, state.listeners = record.reach, record.listeners
    if record.prior is not None:
        matrix, vector, reference = (unpack(a) for a in record.prior.arrays)
        state.prior = Prior(tuple(record.prior.keys), matrix, vector, reference, record.prior.epochs)
    return state
