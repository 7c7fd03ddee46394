"""What the tracker keeps of each node beside its block in the Kirchhoff matrix."""

from typing import Literal

import msgspec

from estimator.estimate import Covariance6, Vector3
from estimator.graph.variable import Variable
from estimator.measurements.node import Role

Mode = Literal["undecided", "fixed", "static", "unit", "free", "retired"]
"""undecided: no position yet; fixed: known exactly (the base); static: a position that stays; unit: moves
by the displacements of its PDR unit; free: moves with a velocity of its own; retired: marginalised."""


class NodeState(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
    """One node, as it stands after a tick.

    Attributes:
        node: the node.
        role: what it is.
        named: its role was told by a `node` reading, not guessed from the first reading that named it.
        mode: how its position is held.
        t: epoch of its newest fused reading.
        pose_t: epoch that its position refers to, where it moves.
        unit_t: epoch of its unit's newest displacement.
        place_m: its position where it is fixed or retired.
        covariance_m2: of `place_m`, where it is retired.
        heading_rad: as told by its `node` reading.
        heading_sigma_rad: as told by its `node` reading.
        unit_heading_rad: newest heading that its unit reported, in the unit's frame.
        speed_mps: horizontal speed by its newest displacement.
        trail: epochs, and displacements summed up to them in the unit's frame: newest seconds only.
        still: epochs and reported headings since it stands still, as far as they are not used yet.
        way_m: length of its way so far.
        pressure_t: epoch of its newest fused pressure.
    """

    node: str
    role: Role
    named: bool = False
    mode: Mode = "undecided"
    t: float
    pose_t: float = 0.0
    unit_t: float | None = None
    place_m: Vector3 | None = None
    covariance_m2: Covariance6 | None = None
    heading_rad: float | None = None
    heading_sigma_rad: float | None = None
    unit_heading_rad: float | None = None
    speed_mps: float | None = None
    trail: tuple[tuple[float, float, float, float], ...] = ()
    still: tuple[tuple[float, float], ...] = ()
    way_m: float = 0.0
    pressure_t: float | None = None

    @property
    def position(self) -> Variable:
        """The block of its position."""
        return Variable("position", self.node)

    @property
    def unit(self) -> Variable:
        """The block of its PDR unit's errors."""
        return Variable("unit", self.node)

    @property
    def velocity(self) -> Variable:
        """The block of its velocity."""
        return Variable("velocity", self.node)

    @property
    def decided(self) -> bool:
        """Whether readings can be held against its position."""
        return self.mode in ("fixed", "static", "unit", "free")

    @property
    def moving(self) -> bool:
        """Whether its position changes with time."""
        return self.mode in ("unit", "free")


class Clone(msgspec.Struct, frozen=True, array_like=True):
    """A kept position of a moving node, for the sightings of an undecided one.

    Attributes:
        node: the node that moved on.
        t: epoch.
        still: epochs and reported headings since it stands still, as far as they are not used yet.
        way_m: length of its way up to there.
    """

    node: str
    t: float
    way_m: float

    @property
    def position(self) -> Variable:
        """Its block."""
        return Variable("position", self.node, self.t)


class Sighting(msgspec.Struct, frozen=True, array_like=True):
    """A range or RSSI to an undecided node, kept until its position is decided.

    Attributes:
        kind: `range` or `rssi`.
        t: epoch.
        other: block of the node at the other end; None: it is fixed, at `offset_m`.
        offset_m: where the other end stood from that block.
        value: range (m) or power (dBm).
        sigma: its standard deviation.
        technology: owner of the technology's states.
    """

    kind: Literal["range", "rssi"]
    t: float
    other: Variable | None
    offset_m: Vector3
    value: float
    sigma: float
    technology: str
