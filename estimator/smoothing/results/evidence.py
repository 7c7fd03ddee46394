"""Which measurements hold a fix where it is: the currents of paper A's electrical analogy (section IV-D).

A unit current put in at the node and taken out at the base spreads over all edges of the graph; the power
that an edge takes is its part of the node's effective resistance, which is its covariance: L⁻¹ L L⁻¹ = L⁻¹,
edge by edge. A measurement that many others run beside carries little, and one that everything hangs on
carries all.
"""

from collections.abc import Sequence

import numpy as np

from estimator.evidence import Evidence, EvidenceKind, Measurement
from estimator.fusion import physics
from estimator.fusion.entering.introduce import tuple_of, upper_triangle
from estimator.fusion.entering.technologies import REACH
from estimator.fusion.images import doubt_m2
from estimator.fusion.learned.reach import in_metres
from estimator.fusion.memory.ledger import BEARING, BODY_BEARING, RANGE, RSSI
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.robust import GOOD
from estimator.smoothing.images.alternatives import Mode, alternatives_now
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.priors import own_priors
from estimator.smoothing.keyframes.walks import PLACES, STATES
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.readings.rows import Rows
from estimator.smoothing.results.calibration_doubt import doubted, scales, suspected
from estimator.smoothing.results.heading_arcs import arc_excess_m2, last_headings, responses
from estimator.smoothing.results.late_starts import doubt_now

HELD_MAX = 30
REJECTED_MAX = 20
RECENT_S = 60.0
PAIR_KINDS: dict[int, EvidenceKind] = {
    RANGE: "range",
    RSSI: "rssi",
    BEARING: "bearing",
    BODY_BEARING: "bearing",
}
SINGLE_KINDS: dict[int, EvidenceKind] = {
    physics.NOISES.index(physics.FIX_NOISE): "fix",
    physics.NOISES.index(physics.HEIGHT_NOISE): "height",
    physics.NOISES.index(physics.TURN_NOISE): "stillness",
    physics.NOISES.index(physics.STRAIGHT_NOISE): "straightness",
}


def explain(
    state: FusionState, problem: Problem, solved: Solution, modes: Sequence[Mode], name: str
) -> Evidence | None:
    """What holds the newest fix of a node.

    Args:
        state: the fusion after all readings.
        problem: the whole incident.
        solved: its solution, whose chain is solved here.
        modes: its others.
        name: the node.

    Returns:
        None where its position is not decided, or known exactly.

    Raises:
        KeyError: there is no such node.
    """
    node = state.nodes[name]
    layout = problem.layout
    size = layout.length * layout.width
    walk = next((w for w in layout.walks if w.number == node.index), None)
    if walk is not None:
        start = walk.last * layout.width + layout.column_of[walk.number]
        epoch = float(layout.times[walk.last, layout.walks.index(walk)])
    elif node.index in layout.stands and (node.decided or node.mode == "retired"):
        start, epoch = size + layout.stands[node.index], node.t
    else:
        return None
    solved.chain.solve()
    headings, judged = last_headings(layout), scales(layout)
    told = responses(layout, solved, [start, start + 1, start + 2, *headings, *judged])
    covariance = 0.5 * (told[start : start + 3, :3] + told[start : start + 3, :3].T)
    doubt = doubt_m2(alternatives_now(layout, solved.x, modes).get(name, ()), solved.x[start : start + 2])
    across = told[:, :2]
    total = float(np.trace(covariance[:2, :2]))
    doubt += arc_excess_m2(told[:, 3 : 3 + len(headings)], headings, start)
    told_scales = told[:, 3 + len(headings) :]
    doubt += doubted(judged, solved.x, told_scales, suspected(problem, solved), start)
    doubt += doubt_now(layout, name)
    # Last, as for a track: it is the least that a height is unsure by, whatever else there is to doubt.
    doubt[2, 2] = max(doubt[2, 2], node.doubt_up_m2 - float(covariance[2, 2]))
    rows = problem.rows
    flat = _flat(layout, rows)
    carried = np.einsum(
        "mk,mkc->mc", solved.linear.jacobian, np.where(flat[..., None] >= 0, across[flat], 0.0)
    )
    carried = _shared_off(rows, solved.weighted.information, carried)
    # What is thought of shadows beforehand is nobody's measurement.
    power = (solved.weighted.information * (carried**2).sum(axis=1) / total)[: len(rows.shadows.of)]
    listed = [
        _row(state, rows, solved, flat, i, float(power[i])) for i in np.argsort(-power)[:HELD_MAX].tolist()
    ]
    listed += _walked(layout, solved, across, total)
    listed += _known(problem, solved, across, total)
    held = sorted(_joined(listed), key=lambda m: -m.share)[:HELD_MAX]
    held = [m for m in held if m.share > 1e-4]
    bad = np.flatnonzero(((solved.weighted.good < GOOD) & (rows.t > epoch - RECENT_S))[: len(power)])
    near = [
        _row(state, rows, solved, flat, i, float(power[i])) for i in bad[np.argsort(-rows.t[bad])].tolist()
    ]
    rejected = [m for m in near if name in (m.a, m.b)][:REJECTED_MAX]
    return Evidence(
        node=name,
        t=epoch,
        position_m=tuple_of(solved.x[start : start + 3]),
        covariance_m2=upper_triangle(covariance + doubt),
        held=held,
        rejected=rejected,
        rest=max(1.0 - sum(m.share for m in held), 0.0),
    )


def _shared_off(rows: Rows, information: Array, carried: Array) -> Array:
    """What rows carry, m × c, less what is carried off by the shadow in which each lies."""
    shared, left = rows.lying, carried.copy()
    for one, own in enumerate(shared.own.tolist()):
        at = np.append(shared.rows[shared.ends[one] : shared.ends[one + 1]], own)
        left[at] -= information[at] @ carried[at] / information[at].sum()
    return left


def _flat(layout: Layout, rows: Rows) -> Array:
    size = layout.length * layout.width
    keyframe = rows.slab[:, None] * layout.width + rows.columns
    border = size + rows.columns - layout.width
    return np.where(rows.columns < 0, -1, np.where(rows.columns < layout.width, keyframe, border))


def _row(state: FusionState, rows: Rows, solved: Solution, flat: Array, i: int, share: float) -> Measurement:
    owners, m, n = state.owners, len(rows.pairs), len(rows.singles)
    b: str | None = None
    kind: EvidenceKind
    if i < m:
        pair = rows.pairs[i]
        kind, a, b, value = PAIR_KINDS[int(pair[1])], owners[int(pair[2])], owners[int(pair[3])], pair[4]
    elif i < m + n:
        single = rows.singles[i - m]
        kind, a, value = SINGLE_KINDS[int(single[5])], owners[int(single[1])], single[3]
    else:
        drop = rows.drops[(i - m - n) // 3]
        kind, a, b, value = "drop", owners[int(drop[2])], owners[int(drop[1])], 0.0
    residual, sigma = float(solved.linear.residual[i] + rows.shift[i]), float(rows.sigma[i])
    if kind == "rssi" and state.sources[int(rows.source[i])] == REACH:
        kind = "reach"
        value, residual, sigma = in_metres(float(solved.x[flat[i, 2 * STATES]]), residual, sigma)
    return Measurement(
        kind=kind,
        t=float(rows.t[i]),
        a=a,
        b=b,
        value=float(value),
        residual=residual,
        sigma=sigma,
        weight=float(solved.weighted.good[i]),
        share=share,
    )


def _joined(listed: list[Measurement]) -> list[Measurement]:
    """A drop and a fix are three rows each, and one measurement."""
    kept: dict[tuple[object, ...], Measurement] = {}
    for one in listed:
        whole = one.kind in ("drop", "fix")
        key = (
            (one.kind, one.t, one.a, one.b) if whole else (one.kind, one.t, one.a, one.b, one.value, id(one))
        )
        known = kept.get(key)
        if known is None:
            kept[key] = one
        else:
            kept[key] = Measurement(
                kind=one.kind,
                t=one.t,
                a=one.a,
                b=one.b,
                value=known.value,
                residual=float(np.hypot(known.residual, one.residual)),
                sigma=known.sigma,
                weight=min(known.weight, one.weight),
                share=known.share + one.share,
            )
    return list(kept.values())


def _walked(layout: Layout, solved: Solution, across: Array, total: float) -> list[Measurement]:
    """Each unit's dead reckoning as one measurement: the power of all its steps."""
    found = []
    size = layout.length * layout.width
    keyframes = across[:size].reshape(layout.length, layout.width, 2)
    for i, (walk, motion) in enumerate(zip(layout.walks, solved.motions, strict=True)):
        if walk.way is None or not len(motion.noise):
            continue
        own = slice(STATES * i, STATES * (i + 1))
        states = keyframes[walk.first : walk.last + 1, own]
        moved = states[1:] - np.matmul(motion.transition, states[:-1])
        power = np.einsum("kic,kij,kjc->", moved, motion.information, moved) / total
        times = layout.times[[walk.first, walk.last], i]
        sums = walk.way.between(times[:1], times[1:])[0]
        found.append(
            Measurement(
                kind="displacement",
                t=float(times[1]),
                a=walk.node.node,
                value=float(sums[11]),
                residual=float(np.linalg.norm(motion.residual[:, :2].sum(axis=0))),
                sigma=float(np.sqrt(2.0 * max(sums[6], 0.0))),
                weight=1.0,
                share=float(power),
            )
        )
    return found


def _known(problem: Problem, solved: Solution, across: Array, total: float) -> list[Measurement]:
    """What was known beforehand of each node, where it began and how its unit errs, as one measurement."""
    layout, known = problem.layout, own_priors(problem.layout, ())
    power = np.zeros(len(across))
    np.add.at(power, known.at, known.information * (across[known.at] ** 2).sum(axis=1) / total)
    off, sigma = np.zeros(len(across)), np.zeros(len(across))
    off[known.at], sigma[known.at] = solved.x[known.at] - known.mean, known.information**-0.5
    size, owners = layout.length * layout.width, layout.state.owners
    began = [
        (walk.number, float(layout.times[walk.first, i]), walk.first * layout.width + STATES * i, STATES)
        for i, walk in enumerate(layout.walks)
    ]
    for row in layout.state.ledger.table("stands"):
        number = int(row[1])
        began.append((number, float(row[0]), size + layout.stands[number], PLACES))
    return [
        Measurement(
            kind="prior",
            t=t,
            a=owners[number],
            value=0.0,
            residual=float(np.linalg.norm(off[start : start + 2])),
            sigma=float(sigma[start]),
            weight=1.0,
            share=float(power[start : start + numbers].sum()),
        )
        for number, t, start, numbers in began
    ]
