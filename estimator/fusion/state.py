"""Everything that the fusion remembers between two ticks."""

from typing import Literal, Self

import numpy as np

from estimator.estimate import Notice, NoticeCode, Vector3
from estimator.fusion.nodes import Clone, NodeState, Sighting
from estimator.fusion.noise import LearnedNoise, Link
from estimator.graph.dense import Array
from estimator.graph.kirchhoff import Kirchhoff
from estimator.measurements import AnyReading
from estimator.measurements.node import Role

Count = Literal["fused", "not_fused", "outlier"]


class FusionState:
    """The Kirchhoff state and what surrounds it; copying is cheap, because every record is immutable.

    Attributes:
        origin_wgs84: latitude (°), longitude (°), height (m) of the local origin, if known.
        graph: L, b and x.
        nodes: every node ever introduced, in order of introduction.
        sightings: of undecided nodes.
        clones: kept positions of moving nodes.
        waiting: readings whose epoch no displacement has covered yet.
        noise: what was learned of each technology's noise.
        links: the newest reading of each technology between two nodes.
        reference_pa: the base's newest air pressure.
        counts: readings fused, not fused, weighed as outliers.
        said: notices that are given once.
        tried: how many sightings an undecided node had when it was last tried.
        clone_step: way between kept positions, where it is no longer the usual one (m).
        notices: of this tick.
    """

    def __init__(self, origin_wgs84: tuple[float, float, float] | None = None) -> None:
        self.origin_wgs84 = origin_wgs84
        self.graph = Kirchhoff()
        self.nodes: dict[str, NodeState] = {}
        self.sightings: dict[str, tuple[Sighting, ...]] = {}
        self.clones: dict[str, tuple[Clone, ...]] = {}
        self.waiting: tuple[AnyReading, ...] = ()
        self.noise: dict[str, LearnedNoise] = {}
        self.links: dict[str, Link] = {}
        self.reference_pa: float | None = None
        self.counts: dict[str, int] = {"fused": 0, "not_fused": 0, "outlier": 0}
        self.said: dict[str, None] = {}
        self.tried: dict[str, int] = {}
        self.clone_step: dict[str, float] = {}
        self.notices: list[Notice] = []

    def copy(self) -> Self:
        """An independent copy, without this tick's notices."""
        twin = type(self)(self.origin_wgs84)
        twin.graph = self.graph.copy()
        twin.nodes, twin.sightings, twin.clones = dict(self.nodes), dict(self.sightings), dict(self.clones)
        twin.waiting, twin.noise, twin.reference_pa = self.waiting, dict(self.noise), self.reference_pa
        twin.counts, twin.said, twin.tried = dict(self.counts), dict(self.said), dict(self.tried)
        twin.clone_step, twin.links = dict(self.clone_step), dict(self.links)
        return twin

    def count(self, what: Count, number: int = 1) -> None:
        """Count readings."""
        self.counts[what] += number

    def say(self, code: NoticeCode, t: float, node: str | None, text: str, once: str | None = None) -> None:
        """Give a notice; one with a key `once` is given only once."""
        if once is not None:
            if once in self.said:
                return
            self.said[once] = None
        self.notices.append(Notice(code=code, t=t, node=node, text=text))

    def node_of(self, name: str, role: Role, t: float) -> NodeState:
        """The node, introduced with a guessed role if no reading has named it before."""
        found = self.nodes.get(name)
        if found is None:
            found = self.nodes[name] = NodeState(node=name, role=role, t=t)
        return found

    def place(self, node: NodeState) -> Array:
        """Position of a decided node, 3 (m).

        Raises:
            KeyError: the node is undecided.
        """
        return np.array(node.place_m) if node.place_m is not None else self.graph.value(node.position)

    def base_place(self) -> Vector3:
        """Where the base stands: the origin, unless it says otherwise."""
        for node in self.nodes.values():
            if node.mode == "fixed" and node.place_m is not None:
                return node.place_m
        return (0.0, 0.0, 0.0)

    def learned(self, technology: str) -> LearnedNoise:
        """Noise of a technology, as far as it is known."""
        return self.noise.get(technology, LearnedNoise())
