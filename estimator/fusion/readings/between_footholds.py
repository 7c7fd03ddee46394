"""Where the bearers of boots are that have not come down yet, for a picture.

A boot's way is told from foothold to foothold (decision 0094), a second apart and more. In between its bearer
is between where he would be at his pace and where his boot is: it waits for him first, and is then ahead of
him. Whoever stops stays with it.
"""

import math

from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.fusion.entering.replaced_unit import framed
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.dead_reckoning import advance_units
from estimator.fusion.motion.silence import went_on
from estimator.fusion.motion.steps import Step
from estimator.inertial.under_way import under_way

PASSES = 0.06
"""He passes over a boot that has come down so much of a stride earlier or later than it seems."""
TOWARDS = 2.0
"""A boot that has left tells better than his pace which way he goes: he may turn."""


def step_on(state: FusionState) -> None:
    """Move the bearers of boots to where these are by their newest samples.

    Args:
        state: a copy, changed in place: what is foreseen here is never held against what is told later.
    """
    steps = []
    for name, known in state.navigations.items():
        node, found = state.nodes.get(name), under_way(known, name)
        if node is None or found is None or node.mode != "unit" or not node.raw or node.apart is not None:
            continue
        led, step = framed(node, found.led), Step(node)
        if found.share > 0.0:
            here_m, off_m = _over_soon(led.delta_m, found.share)
        else:
            here_m, off_m = _between(led.delta_m, step.pace_mps(), found.gone_s, known.t - known.told_t)
        if step.take(replace(led, delta_m=here_m, sigma_m=math.hypot(led.sigma_m or 0.0, off_m))):
            steps.append(step)
    if steps:
        advance_units(state, steps)
    for step in steps:
        state.nodes[step.node.node] = step.after()


def _over_soon(boot_m: Vector3, share: float) -> tuple[Vector3, float]:
    """The way of who is about to pass over a boot that has come down, and its standard deviation (m).

    Args:
        boot_m: from the foothold before to it (m).
        share: of the time from there to when he will have passed over it.
    """
    e, n, u = (share * gone_m for gone_m in boot_m)
    return (e, n, u), math.hypot(0.5 * (1.0 - share), PASSES) * math.hypot(*boot_m)


def _between(boot_m: Vector3, pace_mps: Vector3, gone_s: float, since_s: float) -> tuple[Vector3, float]:
    """The way of whose boot has not come down, and its standard deviation (m).

    Args:
        boot_m: from the foothold before to where it is (m).
        pace_mps: his velocity in the stride before (m/s).
        gone_s: for how long he has gone on at it, if he does (s).
        since_s: how long ago he passed over that foothold (s).
    """
    along_s, across_m2 = went_on(gone_s)[0], went_on(since_s)[1]
    on_m = [along_s * pace for pace in pace_mps]
    to_m = [one + TOWARDS * other for one, other in zip(on_m, boot_m, strict=True)]
    length_m = math.hypot(*to_m)
    turned = math.hypot(*on_m) / length_m if length_m > 0.0 else 0.0
    on_m = [turned * one for one in to_m]
    e, n, u = (0.5 * (one + other) for one, other in zip(on_m, boot_m, strict=True))
    return (e, n, u), math.sqrt(across_m2 + 0.25 * math.dist(on_m, boot_m) ** 2)
