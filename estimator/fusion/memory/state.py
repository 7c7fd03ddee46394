"""Everything that the fusion remembers between two ticks."""

import math
from collections.abc import Iterator
from typing import Literal, Self

import numpy as np

from estimator.estimate import Notice, NoticeCode, Vector3
from estimator.fusion import physics
from estimator.fusion.learned.calibration import SEEN, Calibration, body_sigmas, narrow_sigma
from estimator.fusion.learned.delays import Radio, Suspicion
from estimator.fusion.learned.gyros import bias_sigma_radps
from estimator.fusion.learned.link_correlation import Links
from estimator.fusion.learned.noise import LearnedNoise
from estimator.fusion.learned.reach import Reach
from estimator.fusion.learned.receivers import Receiver
from estimator.fusion.learned.told_places import MistoldPlace
from estimator.fusion.memory.hearing import Crossing, Listener
from estimator.fusion.memory.ledger import RANGE, Ledger
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.prior import Prior
from estimator.graph.dense import Array
from estimator.graph.kirchhoff import Kirchhoff
from estimator.inertial.progress import Navigation
from estimator.inertial.zaru import RESTED_RADPS
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Awaited
from estimator.measurements.node import Node, Role

AnyHeld = AnyReading | Crossing
Count = Literal["fused", "not_fused", "outlier"]


class FusionState:
    """The Kirchhoff state and what surrounds it; copying is cheap, because nearly every record is immutable.

    Attributes:
        origin_wgs84: latitude (°), longitude (°), height (m) of the local origin, if known.
        graph: L, b and x.
        nodes: every node ever introduced, in order of introduction.
        ended: what they were before they came back, by number.
        called: introductions of retired nodes of which nothing has been reported since, by node.
        sightings: how many each undecided node has.
        waiting: readings whose epoch no displacement has covered yet.
        awaited: units whose first reports are still to come, by node.
        noise: what was learned of each technology's noise.
        links: the newest reading of each technology between two nodes.
        reference: newest air pressure of a base (Pa), and how high that base stands (m).
        counts: readings fused, not fused, weighed as outliers.
        said: notices that are given once.
        tried: how many sightings an undecided node had when it was last tried.
        newest_t: end of the newest tick, Unix seconds.
        bent_m: how far updates have bent the window since it was last solved (m).
        level_cost: what a reading has cost at least since it was last asked in vain whether anybody has
            climbed unseen (log likelihood).
        due: the window is to be solved again at once.
        astray_t: since when some unit leads its bearer astray (s).
        suspected: the window is to be solved again soon: the newest readings disagree with a standing node's
            place, or what was just found has bent what follows.
        exposed: somebody may be followed to an image of where he goes: the window is to be solved again
            soon.
        begun_t: end of the first tick with a node in it.
        entered_t: epoch at which the first responder began (s): until then nobody was inside.
        refreshed_t: end of the tick at which the window was last solved.
        window_t: epoch of the window's first keyframe.
        prior: what is known from before the window.
        navigations: of the boots whose units report raw samples, by node.
        calibrations: what is thought of the scale of each ranging technology that reaches odometry.
        bodies: what is thought of what bearers' bodies do to the readings of each technology.
        delayed: the radios whose antenna delay is not calibrated.
        suspects: radios that may have one, and are trusted.
        delays_t: when that was asked last (s).
        mistold: told places that may be wrong, by node.
        altimeters: what they are off by beforehand, and standard deviations of that, by their names (m).
        receivers: what is known beforehand of the fixes of those who fly, by their names.
        lost: what powers and ranges lose by the newest window, by number: it starts from there again (dB, m).
        clocks: how late ranges of radios are stamped against their bearers' steps, by node (s).
        reach: how far radios reach.
        listeners: what each radio has been hearing.
        ledger: what has been fused, as tables.
        owners: the node of each number in the ledger.
        sources: the technologies of the ledger's readings.
        announced: who puts on another unit in this tick, and when (s).
        notices: of this tick.
    """

    def __init__(self, origin_wgs84: tuple[float, float, float] | None = None) -> None:
        self.origin_wgs84 = origin_wgs84
        self.graph = Kirchhoff()
        self.nodes: dict[str, NodeState] = {}
        self.ended: dict[int, NodeState] = {}
        self.called: dict[str, Node] = {}
        self.sightings: dict[str, int] = {}
        self.waiting: tuple[AnyHeld, ...] = ()
        self.awaited: dict[str, Awaited] = {}
        self.noise: dict[str, LearnedNoise] = {}
        self.links = Links()
        self.reference: tuple[float, float] | None = None
        self.counts: dict[str, int] = {"fused": 0, "not_fused": 0, "outlier": 0}
        self.said: dict[str, None] = {}
        self.tried: dict[str, int] = {}
        self.newest_t = 0.0
        self.bent_m = 0.0
        self.level_cost = -math.inf
        self.due = False
        self.astray_t: float | None = None
        self.suspected = False
        self.exposed = True
        self.begun_t: float | None = None
        self.entered_t: float | None = None
        self.refreshed_t = 0.0
        self.window_t: float | None = None
        self.prior: Prior | None = None
        self.navigations: dict[str, Navigation] = {}
        self.calibrations: dict[str, Calibration] = {}
        self.bodies: dict[str, Calibration] = {}
        self.delayed: dict[Radio, None] = {}
        self.suspects: dict[Radio, Suspicion] = {}
        self.delays_t = -math.inf
        self.mistold: dict[str, MistoldPlace] = {}
        self.altimeters: dict[str, tuple[float, float]] = {}
        self.receivers: dict[str, Receiver] = {}
        self.lost: dict[int, float] = {}
        self.clocks: dict[str, float] = {}
        self.reach = Reach()
        self.listeners: dict[str, Listener] = {}
        self.ledger = Ledger()
        self.owners: tuple[str, ...] = ()
        self.sources: tuple[str, ...] = ()
        self.announced: dict[str, float] = {}
        self.notices: list[Notice] = []

    def copy(self) -> Self:
        """An independent copy, without this tick's notices."""
        twin = object.__new__(type(self))
        twin.__dict__ = self.__dict__.copy()
        twin.graph, twin.ledger = self.graph.copy(), self.ledger.copy()
        twin.nodes, twin.links, twin.sightings = dict(self.nodes), self.links.copy(), dict(self.sightings)
        twin.noise, twin.calibrations = dict(self.noise), dict(self.calibrations)
        twin.counts, twin.said, twin.tried = dict(self.counts), dict(self.said), dict(self.tried)
        twin.ended, twin.called, twin.listeners = dict(self.ended), dict(self.called), dict(self.listeners)
        twin.navigations, twin.notices = dict(self.navigations), []
        twin.awaited = dict(self.awaited)
        twin.delayed, twin.suspects = dict(self.delayed), dict(self.suspects)
        twin.altimeters, twin.receivers = dict(self.altimeters), dict(self.receivers)
        twin.clocks, twin.mistold, twin.bodies = dict(self.clocks), dict(self.mistold), dict(self.bodies)
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
            found = self.nodes[name] = NodeState(node=name, role=role, t=t, index=self.number(name))
        return found

    def lives(self) -> Iterator[NodeState]:
        """The states of all nodes, and the ended ones of those that were retired and came back."""
        yield from self.ended.values()
        yield from self.nodes.values()

    def life(self, number: int) -> NodeState:
        """State of the node with a number in the ledger: the present one, or the one that ended under it."""
        return self.ended.get(number) or self.nodes[self.owners[number]]

    def keep(self, life: NodeState) -> None:
        """Replace the state that `life` gives for its number."""
        if life.index in self.ended:
            self.ended[life.index] = life
        else:
            self.nodes[life.node] = life

    def keep_poses(self) -> None:
        """Enter everyone's present state in the ledger: the next solution of the window starts from there."""
        reference, starts = self.graph.reference.tolist(), self.graph.starts
        for node in self.nodes.values():
            if node.moving:
                unit = node.mode == "unit"
                here, rest = starts[node.position], starts[node.unit if unit else node.velocity]
                values = (*reference[here : here + 3], *reference[rest : rest + 3])
                self.ledger.add("poses", node.pose_t, node.index, float(unit), *values)

    def number(self, name: str) -> int:
        """A new number in the ledger for a node, which enters or lies elsewhere now."""
        self.links.renew(name)
        self.owners = (*self.owners, name)
        return len(self.owners) - 1

    def source(self, name: str) -> int:
        """Number of a technology in the ledger."""
        if name not in self.sources:
            self.sources = (*self.sources, name)
        return self.sources.index(name)

    def place(self, node: NodeState) -> Array:
        """Position of a decided node, 3 (m).

        Raises:
            KeyError: the node is undecided.
        """
        return np.array(node.place_m) if node.place_m is not None else self.graph.value(node.position)

    def base_place(self) -> Vector3:
        """Where the base stands, or stood if all are retired: the origin, unless it says otherwise."""
        left: Vector3 | None = None
        for node in self.nodes.values():
            if node.role == "base" and node.place_m is not None:
                if node.mode != "retired":
                    return node.place_m
                left = left or node.place_m
        return left or (0.0, 0.0, 0.0)

    def landmarks(self) -> frozenset[str]:
        """Whose places are told from outside: where the map is turned, they do not turn with it."""
        return frozenset(node.node for node in self.nodes.values() if node.landmark)

    def bias_sigma_radps(self, node: NodeState) -> float:
        """Standard deviation of the prior of the gyro bias of a node's unit (rad/s).

        Where raw samples are navigated, a rest has told it, or displacements say what it is less sure by.
        """
        if node.raw:
            return RESTED_RADPS
        return bias_sigma_radps(node.bias_told, [other.bias_told for other in self.lives()])

    def scale_sigma(self, node: NodeState) -> float:
        """Standard deviation of the prior of the scale of a node's unit."""
        return physics.STRAPDOWN_SCALE_SIGMA if node.raw else physics.SCALE_SIGMA

    def range_scale_sigma(self, technology: str) -> float:
        """Standard deviation of the prior of a ranging technology's scale, of the kind it is taken for."""
        known, narrow = self.calibrations.get(technology), self.narrow_sigma(technology)
        return narrow if known is None else known.scale_sigma(narrow)

    def body_sigma(self, technology: str, powers: bool) -> float:
        """Standard deviation of the prior of what bodies do to readings (m or dB), of the likelier kind."""
        narrow, wide = body_sigmas(technology, powers)
        known = self.bodies.get(technology)
        return narrow if known is None or known.uncalibrated < SEEN else wide

    def narrow_sigma(self, technology: str) -> float:
        """Standard deviation of a ranging technology's scale where it is calibrated."""
        learned, pairs, scatter = self.learned(technology), self.ledger.table("pairs"), math.inf
        if technology in self.sources:
            mine = (pairs[:, 1] == RANGE) & (pairs[:, 6] == self.sources.index(technology))
            length_m, sigma_m = (float(np.sum(pairs[mine, column] ** 2)) ** 0.5 for column in (4, 5))
            scatter = learned.factor * sigma_m / length_m if length_m > 0.0 else math.inf
        return narrow_sigma(learned.outliers(physics.RANGE_NOISE.outliers), scatter)

    def learned(self, technology: str) -> LearnedNoise:
        """Noise of a technology, as far as it is known."""
        return self.noise.get(technology, LearnedNoise())
