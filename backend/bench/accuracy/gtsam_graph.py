"""From readings to factors: what the GTSAM peer adds to its graph, and what has to wait for what."""

from collections import defaultdict
from collections.abc import Callable
from typing import Any

from backend.bench.accuracy.gtsam_begin import SHORTEST_WAY_M, Seen, Tries, guess
from backend.bench.accuracy.gtsam_factors import End, Factors, Offset
from backend.bench.accuracy.gtsam_nodes import Fixed, Pose, Walker, ahead
from backend.bench.accuracy.least_squares import range_of
from estimator.measurements import AnyReading, Displacement, Drop, Node, Position, Range, Rssi

ANCHOR_SIGMA_M = 0.05
START_SIGMA_M = 0.5
GUESS_SIGMA_M = 10.0
"""A guess comes from readings that are in the graph as well: it only keeps the system from being singular."""

HEADING_SIGMA_RAD = 0.1
UNKNOWN_RAD = 3.0
DROP_SIGMA_M = 0.5
FIX_SIGMA_M = (3.0, 3.0)
WITHOUT_PDR_S = 3.0
FEWEST_ANCHORS = 3
KEYS_EACH = 1_000_000
"""More poses than any responder has."""

Pair = Range | Rssi


class Graph:
    """Nodes, and the factors and first values that the solver has not taken yet.

    Args:
        factors: makes them.
        pose_of: the solver's estimate of a key; None where it has none.
        in_db: RSSI is in dB, with P0 and n as a state; else a range by a fixed law, but in the batch.

    Attributes:
        walkers: responders, by name.
        fixed: nodes that stand, by name.
        everything: all factors so far, RSSI in dB.
        hears: there is RSSI among them.
    """

    def __init__(self, factors: Factors, pose_of: Callable[[int], Pose | None], in_db: bool) -> None:
        self._make = factors
        self._pose_of = pose_of
        self._in_db = in_db
        self.hears = False
        self._gtsam = factors.gtsam
        self.walkers: dict[str, Walker] = {}
        self.fixed: dict[str, Fixed] = {}
        self._left_out: set[str] = set()
        self._waiting: dict[str, list[Pair]] = defaultdict(list)
        self._tries = Tries()
        self._newest_s = 0.0
        self._new()
        self.everything = self._gtsam.NonlinearFactorGraph()

    def _new(self) -> None:
        self._factors, self._values = self._gtsam.NonlinearFactorGraph(), self._gtsam.Values()

    def take_new(self) -> tuple[Any, Any]:
        """Factors and first values added since the last time."""
        taken = self._factors, self._values
        self._new()
        return taken

    def begun(self) -> list[Walker | Fixed]:
        """All nodes in the graph."""
        nodes: list[Walker | Fixed] = [*self.walkers.values(), *self.fixed.values()]
        return [node for node in nodes if node.begun]

    def place(self, walker: Walker, t: float) -> Pose:
        """Where a begun walker was at `t`, near its last pose (m, rad)."""
        if walker.pose is None:
            raise ValueError("the walker has not begun")
        index, offset = walker.at(t)
        return ahead(walker.pose, offset) if index == walker.sent - 1 else walker.pose

    def take(self, reading: AnyReading) -> None:
        """Take a reading in; kinds that say nothing of places in the plane are passed over."""
        self._newest_s = max(self._newest_s, reading.t)
        match reading:
            case Node():
                self._introduce(reading)
            case Displacement() if reading.node in self.walkers:
                self._move(self.walkers[reading.node], reading)
                self._again(reading.node)
            case Drop() if reading.node not in self.fixed or not self.fixed[reading.node].begun:
                node = self.fixed.setdefault(reading.node, self._new_fixed())
                node.by = (reading.by, reading.t)
                self._drop(reading.node, node)
            case Position():
                self._fix(reading)
            case Range() | Rssi():
                self._add(reading)
            case _:
                pass

    def retry(self) -> None:
        """Take up again what waited for an estimate."""
        for name, walker in self.walkers.items():
            late = self._newest_s - walker.start_s > WITHOUT_PDR_S
            if walker.reckons is None and late:
                walker.reckons = False
                self._again(name)
            if not walker.begun:
                self._guess_walker(name, walker)
        for name, node in self.fixed.items():
            if not node.begun and node.by is None:
                self._guess_fixed(name, node)

    def _new_fixed(self) -> Fixed:
        return Fixed(self._gtsam.symbol("f", len(self.fixed)))

    def _introduce(self, reading: Node) -> None:
        name = reading.node
        if reading.role == "uav":
            self._left_out.add(name)
        elif reading.role == "responder" and name not in self.walkers:
            key = self._gtsam.symbol("x", KEYS_EACH * len(self.walkers))
            walker = self.walkers[name] = Walker(key, reading.t)
            if reading.position_m is not None:
                walker.up_m = reading.position_m[2]
                pose = (*reading.position_m[:2], reading.heading_rad or 0.0)
                turn = reading.heading_sigma_rad or HEADING_SIGMA_RAD
                self._begin_walker(name, walker, pose, reading.sigma_m or START_SIGMA_M, turn)
            elif reading.heading_sigma_rad is not None and reading.heading_sigma_rad < 1.0:
                walker.turn_rad = reading.heading_rad or 0.0
        elif reading.role != "responder":
            node = self.fixed.setdefault(name, self._new_fixed())
            where = reading.position_m or ((0.0, 0.0, 0.0) if reading.role == "base" else None)
            if where is not None and not node.begun:
                self._begin_fixed(name, node, where[:2], reading.sigma_m or ANCHOR_SIGMA_M)

    def _begin_fixed(self, name: str, node: Fixed, where: Offset, sigma_m: float) -> None:
        node.pose = (*where, 0.0)
        self._values.insert(node.key, self._make.pose(*node.pose))
        self._put(self._make.prior(node.key, self._make.pose(*node.pose), sigma_m, 0.1))
        self._again(name)

    def _begin_walker(self, name: str, walker: Walker, pose: Pose, sigma_m: float, sigma_rad: float) -> None:
        walker.pose, walker.sent = pose, 1
        self._values.insert(walker.first_key, self._make.pose(*pose))
        self._put(self._make.prior(walker.first_key, self._make.pose(*pose), sigma_m, sigma_rad))
        self._chain(walker)
        self._again(name)

    def _move(self, walker: Walker, reading: Displacement) -> None:
        walker.move(reading)
        self._chain(walker)

    def _chain(self, walker: Walker) -> None:
        """Put poses into the graph that are reckoned but not in it."""
        while walker.pose is not None and walker.sent < len(walker.poses):
            i, j = walker.poses[walker.sent - 1], walker.poses[walker.sent]
            (east, north), (to_east, to_north) = walker.way_m[i], walker.way_m[j]
            delta, span_s = (to_east - east, to_north - north), walker.t_s[j] - walker.t_s[i]
            a, b = walker.key, walker.key + 1
            if walker.reckons is False:
                self._put(self._make.wander(a, b, span_s))
            else:
                way_m = walker.walked_m[j] - walker.walked_m[i]
                self._put(self._make.step(a, b, delta, way_m, span_s))
            walker.pose = ahead(walker.pose, delta)
            walker.sent += 1
            self._values.insert(b, self._make.pose(*walker.pose))

    def _again(self, name: str) -> None:
        """What waited for a node is taken in, or waits for another one; drops by it as well."""
        for dropped, node in self.fixed.items():
            if node.by is not None and node.by[0] == name and not node.begun:
                self._drop(dropped, node)
        for reading in self._waiting.pop(name, []):
            self._add(reading)

    def _drop(self, name: str, node: Fixed) -> None:
        if node.by is None or node.by[0] not in self.walkers:
            return
        walker, t = self.walkers[node.by[0]], node.by[1]
        if walker.pose is None or not walker.covers(t):
            return
        index, offset = walker.at(t)
        node.pose, node.by, node.up_m = self.place(walker, t), None, walker.up_m
        self._values.insert(node.key, self._make.pose(*node.pose))
        self._put(self._make.between(walker.first_key + index, node.key, offset, DROP_SIGMA_M, 0.1))
        self._again(name)

    def _fix(self, reading: Position) -> None:
        """A fix: a node may begin with it; of one that has begun it is one more reading."""
        if reading.position_m is None or reading.node in self._left_out:
            return
        where, sigma_m = reading.position_m[:2], max(reading.sigma_m or FIX_SIGMA_M)
        node, walker = self.fixed.get(reading.node), self.walkers.get(reading.node)
        end = self._end(reading.node, reading.t)
        if node is not None and not node.begun and node.by is None:
            self._begin_fixed(reading.node, node, where, sigma_m)
        elif walker is not None and not walker.begun and len(walker.poses) == 1:
            pose = (*where, walker.turn_rad or 0.0)
            self._begin_walker(reading.node, walker, pose, sigma_m, HEADING_SIGMA_RAD)
        elif end is not None:
            east, north, _ = ahead((0.0, 0.0, walker.turned if walker else 0.0), end[1])
            self._put(self._make.place(end[0], where[0] - east, where[1] - north, sigma_m))

    def _add(self, reading: Pair) -> None:
        names = (reading.a, reading.b)
        if self._left_out.intersection(names):
            return
        for name in names:
            walker = self.walkers.get(name)
            if walker is not None and walker.reckons is False:
                walker.stay(reading.t)
                self._chain(walker)
        ends = [self._end(name, reading.t) for name in names]
        for name, end in zip(names, ends, strict=True):
            if end is None:
                self._waiting[name].append(reading)
                return
        known = [end for end in ends if end is not None]
        if isinstance(reading, Range):
            self._put(self._make.range(reading, *self._one_offset(reading, known[0], known[1])))
        else:
            self._rssi(reading, known[0], known[1])

    def _rssi(self, reading: Rssi, a: End, b: End) -> None:
        if not self.hears:
            self.hears = True
            self.everything.add(self._make.path_loss_prior())
            if self._in_db:
                self._factors.add(self._make.path_loss_prior())
                self._values.insert(self._make.path_loss, self._make.path_loss_guess())
        in_db = self._make.rssi(reading, a, b)
        if self._in_db:
            self._put(in_db)
            return
        distance_m, sigma_m = range_of(reading)
        ranged = Range(t=reading.t, a=reading.a, b=reading.b, range_m=distance_m, sigma_m=sigma_m)
        self._put(self._make.range(ranged, *self._one_offset(ranged, a, b)), in_db)

    def _put(self, factor: Any, in_batch: Any = None) -> None:
        """Add a factor, for the batch perhaps in another form."""
        self._factors.add(factor)
        self.everything.add(factor if in_batch is None else in_batch)

    def _end(self, name: str, t: float) -> End | None:
        """Where a reading takes hold of a node; None while that is open."""
        node = self.fixed.get(name)
        if node is not None:
            return (node.key, (0.0, 0.0)) if node.begun else None
        walker = self.walkers.get(name)
        if walker is None or not walker.begun or not walker.covers(t):
            return None
        index, offset = walker.at(t)
        return walker.first_key + index, offset

    def _one_offset(self, reading: Range, a: End, b: End) -> tuple[End, End]:
        """The same ends, the offset of `b` taken over by `a`: GTSAM's factor has but one."""
        first, second = self.walkers.get(reading.a), self.walkers.get(reading.b)
        if first is None or second is None:
            return (a, b) if second is None else (b, a)
        turn = second.turned - first.turned
        east, north, _ = ahead((0.0, 0.0, turn), b[1])
        return (a[0], (a[1][0] - east, a[1][1] - north)), (b[0], (0.0, 0.0))

    def _guess_walker(self, name: str, walker: Walker) -> None:
        if walker.reckons is None or (walker.reckons and walker.walked_m[-1] < SHORTEST_WAY_M):
            return
        seen = self._seen(name)
        if len({one.known for one in seen}) < FEWEST_ANCHORS or not self._tries.is_worth_one(name, len(seen)):
            return
        turned = walker.reckons and walker.turn_rad is None
        found = guess(seen, turned)
        if found is not None:
            pose = (found[0], found[1], found[2] if turned else walker.turn_rad or 0.0)
            sigma_rad = UNKNOWN_RAD if turned else HEADING_SIGMA_RAD
            self._begin_walker(name, walker, pose, GUESS_SIGMA_M, sigma_rad)

    def _guess_fixed(self, name: str, node: Fixed) -> None:
        seen = self._seen(name)
        if self._tries.is_worth_one(name, len(seen)):
            found = guess(seen, turned=False)
            if found is not None:
                self._begin_fixed(name, node, found[:2], GUESS_SIGMA_M)

    def _seen(self, name: str) -> list[Seen]:
        """The ranges of an undecided node to decided ones, as far as their places are known now."""
        walker = self.walkers.get(name)
        seen = []
        for reading in self._waiting.get(name, ()):
            end = self._end(reading.b if reading.a == name else reading.a, reading.t)
            pose = None if end is None else self._pose_of(end[0])
            if end is not None and pose is not None and (walker is None or walker.covers(reading.t)):
                east, north, _ = ahead(pose, end[1])
                offset = (0.0, 0.0) if walker is None else walker.from_start(reading.t)
                seen.append(Seen((east, north), offset, *range_of(reading)))
        return seen
