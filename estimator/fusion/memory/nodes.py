"""What the tracker keeps of each node beside its block in the Kirchhoff matrix."""

import math
from functools import lru_cache
from typing import Literal

import msgspec

from estimator.estimate import Covariance6, Vector3
from estimator.fusion import physics
from estimator.fusion.images import Alternative
from estimator.fusion.learned.calibration import UNTOLD, Told
from estimator.fusion.learned.gait import Gait
from estimator.fusion.learned.report_period import Cadence
from estimator.fusion.learned.rival import Rival
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.learned.unit_rise import RISES
from estimator.fusion.learned.zaru import Standing
from estimator.fusion.memory.absolute import Absolute
from estimator.fusion.memory.separated_unit import SeparatedUnit
from estimator.graph.variable import Variable
from estimator.measurements.node import Role

Mode = Literal["undecided", "fixed", "static", "unit", "free", "retired"]
"""undecided: no position yet; fixed: known exactly (the base); static: a position that stays; unit: moves
by the displacements of its PDR unit; free: moves with a velocity of its own; retired: marginalised."""


class NodeState(msgspec.Struct, frozen=True, kw_only=True, array_like=True, gc=False):
    """One node, as it stands after a tick.

    Attributes:
        node: the node.
        role: what it is.
        index: number of its block in the ledger; a node that is moved gets a new one.
        named: its role was told in time by a `node` reading, not too late, and not guessed from the first
            reading that named it.
        mode: how its position is held.
        t: epoch of its newest fused reading.
        pose_t: epoch that its position refers to, where it moves.
        unit_t: epoch of its unit's newest displacement.
        report_s: for how long that lasted (s).
        place_m: its position where it is fixed or retired.
        covariance_m2: of `place_m`, where it is retired.
        heading_rad: as told by its `node` reading.
        heading_sigma_rad: as told by its `node` reading.
        device: what hardware it wears, as told by its `node` readings.
        crew: the crew of a responder, as told by its `node` readings.
        changed: when another unit was told to be worn (s), and what it faces, if that was told (rad); until
            that one reports.
        rival: its way by ranges alone, beside the one that its unit tells.
        frame_rad: how the frame of its unit is turned against the one that ψ counts from (rad).
        apart: its unit is not where its radio is.
        joined_t: when its unit told again how its radio goes (s).
        carried_t: its bearer is carried: epoch of the newest report of its unit that it stands (s).
        carried_m: how far its unit has got since that report: east, north in the unit's frame (m).
        standing_asked_t: when it was last asked in vain whether he was carried while it stood (s).
        image_asked_t: when it was last asked about in its turn whether it is at an image (s).
        worn: how its unit is taken to be worn, see `entering.unit_mounting.Mounting`.
        first_heading_rad: heading that its unit reported first, in the unit's frame.
        unit_heading_rad: newest heading that its unit reported, in the unit's frame.
        speed_mps: horizontal speed by its newest displacement.
        faced: where its bearer last went, as a unit vector in the unit's frame; nil before he has set out.
        trail: epochs, and displacements summed up to them in the unit's frame: newest seconds only.
        still: headings that its unit has reported since it stands still.
        straight: what straight legs have told of its unit's gyro.
        way_m: length of its way so far.
        absolute: what fixes, heights and `node` readings have told of its place.
        pressure_t: epoch of its newest fused pressure.
        heights: heights have been told of it, by a fix, an altimeter or an air pressure.
        raw: its unit reports raw samples, which are navigated here.
        level: its unit has never reported a change of height.
        unseen_up_m2: variance of its height by the stairs that such a unit does not see.
        gait: how its bearer goes, by its unit.
        rises: by what its unit's heights rise by themselves, for each metre of its way (m/m).
        rises_before: what displacements that are forgotten have told of that (m/m), and its variance.
        climbs: distances have told that its bearer has climbed unseen by it.
        turned: its unit's frame may be turned by any angle: every window is tried with several.
        bent: the window's newest solution has its unit face elsewhere at first than was told.
        bias_told: what readings say of its unit's gyro bias without its prior.
        otherwise: where it may be instead, by what readings tell as well.
        whole_t: since when its unit's displacements follow each other without a gap; while it is undecided,
            since when they come (s).
        missed_s: for how long it has told nothing, all gaps since it last told a whole stride.
        placed_t: epoch of the newest range or fix by which its bearer was followed while it was silent (s).
        cadence: how its unit reports, of displacements of which it does not say since when they are.
        detours: where it may be instead because its unit's frame may have turned on the way.
        power_cost: what a power that it hears has cost at least since it was last asked in vain whether that
            frame has turned (log likelihood).
        place_told_t: epoch of what told last where it stands, or that it lies elsewhere now (s).
        device_told_t: epoch of the `node` reading that told its device (s).
        inside: it was introduced too late: it has entered long ago, and may be anywhere by now.
        introduced_t: epoch of the first introduction or drop that came in time (s).
        walk_factors: learned variances of its unit over the assumed ones: of displacements, of its heading.
    """

    node: str
    role: Role
    index: int = -1
    named: bool = False
    mode: Mode = "undecided"
    t: float
    pose_t: float = 0.0
    unit_t: float | None = None
    report_s: float = 0.0
    place_m: Vector3 | None = None
    covariance_m2: Covariance6 | None = None
    heading_rad: float | None = None
    heading_sigma_rad: float | None = None
    first_heading_rad: float | None = None
    unit_heading_rad: float | None = None
    speed_mps: float | None = None
    faced: tuple[float, float] = (0.0, 0.0)
    trail: tuple[tuple[float, float, float, float], ...] = ()
    still: Standing | None = None
    straight: StraightLegs = StraightLegs()
    way_m: float = 0.0
    absolute: Absolute = Absolute()
    pressure_t: float | None = None
    heights: bool = False
    raw: bool = False
    level: bool = True
    unseen_up_m2: float = 0.0
    gait: Gait = Gait()
    rises: float = 0.0
    rises_before: tuple[float, float] = (0.0, RISES**2)
    climbs: bool = False
    walk_factors: tuple[float, float] = (1.0, 1.0)
    turned: bool = False
    bent: bool = False
    bias_told: Told = UNTOLD
    otherwise: tuple[Alternative, ...] = ()
    device: str | None = None
    crew: str | None = None
    changed: tuple[float, float | None] | None = None
    frame_rad: float = 0.0
    rival: Rival | None = None
    apart: SeparatedUnit | None = None
    joined_t: float = -math.inf
    carried_t: float | None = None
    carried_m: tuple[float, float] = (0.0, 0.0)
    standing_asked_t: float = -math.inf
    image_asked_t: float = -math.inf
    worn: tuple[bool, float] = (False, 0.0)
    whole_t: float = math.inf
    missed_s: float = 0.0
    cadence: Cadence = Cadence()
    placed_t: float = -math.inf
    detours: tuple[Alternative, ...] = ()
    power_cost: float = -math.inf
    place_told_t: float = -math.inf
    device_told_t: float = -math.inf
    inside: bool = False
    introduced_t: float = -math.inf

    @property
    def position(self) -> Variable:
        """The block of its position."""
        return _blocks(self.node)[0]

    @property
    def unit(self) -> Variable:
        """The block of its PDR unit's errors."""
        return _blocks(self.node)[1]

    @property
    def velocity(self) -> Variable:
        """The block of its velocity."""
        return _blocks(self.node)[2]

    @property
    def decided(self) -> bool:
        """Whether readings can be held against its position."""
        return self.mode in ("fixed", "static", "unit", "free")

    @property
    def landmark(self) -> bool:
        """Whether its place is told from outside, as an anchor's, or by its own fixes, as a UAV's is."""
        if self.role == "uav":
            return self.absolute.fixes.t is not None
        return self.mode == "static" and self.absolute.believed_m is not None

    @property
    def wait_s(self) -> float:
        """For how long readings wait for its unit's next report (s)."""
        lasted_s = self.report_s if self.report_s <= physics.REPORT_LONGEST_S else 0.0
        return max(physics.PENDING_S, physics.REPORT_LATE * lasted_s)

    @property
    def doubt_up_m2(self) -> float:
        """The least that its height is unsure by, where nothing tells it: stairs unseen (m²)."""
        return 0.0 if self.heights else self.unseen_up_m2

    @property
    def moving(self) -> bool:
        """Whether its position changes with time."""
        return self.mode in ("unit", "free")


@lru_cache(maxsize=4096)
def _blocks(node: str) -> tuple[Variable, Variable, Variable]:
    """A node's blocks: each tick asks for all of them several times."""
    return Variable("position", node), Variable("unit", node), Variable("velocity", node)
