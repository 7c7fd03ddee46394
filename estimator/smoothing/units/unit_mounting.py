"""Whose unit is worn the wrong way round: mirrored, or turned, or faced elsewhere than was told.

A unit that is mirrored leads its bearer along a mirrored way, and what he drops lies there: a world that is
as consistent as the true one, until something off its axis contradicts it; and then somebody else's good unit
may be blamed. No step of a solution leads from one to the other. So where anything speaks against a unit, a
window is also solved with what each of them reports the other way round.
"""

import math
from collections.abc import Callable, Mapping

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.fusion.entering.unit_mounting import RIGHT, Mounting, mount, mounting_of
from estimator.fusion.images import ALWAYS, Image
from estimator.fusion.learned.rival import DOUBTED, LED_ASTRAY
from estimator.fusion.memory.ledger import RSSI
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.smoothing.images.alternatives import Mode
from estimator.smoothing.images.earlier_images import LEAST
from estimator.smoothing.images.heading_images import reports_from
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.keyframes.walks import HEADING, STATES
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.mounting_hypotheses import SLACKS_M, MountingHypothesis, hypotheses
from estimator.smoothing.units.turned_starts import told_turn

CLEARER, OPEN = 20.0, 2.0
"""A unit is taken to be worn another way where that is likelier by this much (log odds): a window that was
bent otherwise has made 18 of none. Where one is, another way is taken by less. From that on it is open:
another way is told along, at most as likely as what is shown. Powers share their errors, and have made 32 of
none: by them alone it is open, and no more."""
BENT = 2.5
"""A heading that a solution has so many sigmas off from what was told of it speaks against what was told."""
GONE_M = 2.0
"""Who has gone less has hardly told how his unit is worn."""
MOST, SOME = 4, 3
"""Of so many units it is asked where anything speaks against one; of so many where not."""
FIRST_S, LONGER, LITTLE_LONGER, YOUNG_S = 6.0, 1.5, 1.15, 60.0
"""It is asked when a window is half as long again, from so long on; a little longer where anything speaks. Of
one that is no longer young nothing is asked where nothing even hints at it: each way costs a solution."""
HINTED = -4.5
"""Log odds from which on something hints at a bad unit."""


def likeliest_mounting(
    problem: Problem,
    solved: Solution,
    build: Callable[[FusionState], Problem],
    resting: float,
    asked_t: float | None = None,
) -> tuple[Problem, Solution, list[Mode]]:
    """Take units to be worn as is likeliest, where anything speaks against one.

    Args:
        problem: of a window; its state is told how units are worn.
        solved: its solution.
        build: makes the same problem of another state.
        resting: see `Problem.solve`.
        asked_t: when it was last solved (s): where nothing speaks against anybody's unit it is asked by the
            clock, whether another way fits nearly as well; None: it is not asked then.

    Returns:
        The window, its solution, and its others.
    """
    state, layout = problem.layout.state, problem.layout
    bent = bent_headings(layout, solved.x)
    asked = asked_of(problem, asked_t, bent)
    for walk in layout.walks:
        node = state.life(walk.number)
        if node.bent != (walk.number in bent):
            state.keep(replace(node, bent=not node.bent))
    numbers = [layout.walks[i].number for i in asked]
    anew = bool(bent) or _speak(state)
    found = hypotheses(state, numbers, solved.x, build, resting, anew) if asked else []
    if not found:
        return problem, solved, _kept(layout, solved.x)
    known = found[0]
    best = min(found, key=lambda guess: guess.cost)
    worn = any(mounting_of(state.life(number)) != RIGHT for number in numbers)
    told = worn or any(_is_open(state.life(number)) for number in numbers)
    gain = known.cost - best.cost
    if gain < OPEN and not told:
        # As long as all units seem to be worn the right way, nothing of this is told.
        return problem, solved, _kept(layout, solved.x)
    ranged = all(_ranged(problem, number) for number, _ in best.worn)
    if not ranged or gain < (OPEN if worn else CLEARER):
        if not ranged or not worn:
            found = [guess._replace(cost=max(guess.cost, known.cost)) for guess in found]
        best = known = found[0]
    now = {number: mounting_of(state.life(number)) for number in numbers}
    less = np.array([best.cost - guess.cost for guess in found])
    share = np.exp(less - less.max())
    share /= share.sum()
    if best is not known:
        _take(state, best)
        problem = build(state)
        solved = problem.solve(best.x, SLACKS_M[1:], resting=resting)
    modes = [
        _mode(guess, best, now, each)
        for guess, each in zip(found, share.tolist(), strict=True)
        if guess is not best and each > LEAST
    ]
    if not modes:
        _tell(state)
    return problem, solved, modes


def bent_headings(layout: Layout, x: Array) -> dict[int, float]:
    """Units that a solution has face elsewhere at first than was told, by number: by how many sigmas.

    Args:
        layout: of a window.
        x: its solution, flat.
    """
    found = dict[int, float]()
    for i, walk in enumerate(layout.walks):
        if walk.way is not None and walk.begins:
            told_rad, sigma_rad = told_turn(layout, walk.number)
            faced_rad = float(layout.states(x, i)[reports_from(layout, i), HEADING])
            sigmas = abs(within_pi(faced_rad - told_rad)) / sigma_rad
            if sigmas > BENT:
                found[walk.number] = sigmas
    return found


def asked_of(problem: Problem, asked_t: float | None, bent: Mapping[int, float]) -> list[int]:
    """Walks of whose units it is asked how they are worn, by index.

    It is asked by the clock, again when the window has become longer, and at once when a solution first bends
    what a unit faced at first. Those are asked about first against whom most speaks; where nothing even hints
    at anybody some are, while the window is young.

    Args:
        problem: of a window.
        asked_t: when it was last solved (s); None: it is asked only where anything speaks against a unit.
        bent: see `bent_headings`.
    """
    layout = problem.layout
    state, known = layout.state, () if problem.prior is None else problem.prior.keys
    speaks = bool(bent) or _speak(state)
    hinted = speaks or _speak(state, HINTED)
    length_s = state.newest_t - float(layout.grid[0])
    if asked_t is None:
        due = speaks
    else:
        longer = LITTLE_LONGER if speaks else LONGER
        before_s = length_s - (state.newest_t - asked_t)
        due = _times(before_s, longer) < _times(length_s, longer) and (hinted or length_s < YOUNG_S)
        due = due or any(not state.life(number).bent for number in bent)
    if not due:
        return []
    found = [
        i
        for i, walk in enumerate(layout.walks)
        if _askable(state.life(walk.number), walk)
        and ("walk", walk.number) not in known
        and _told_of(problem, walk)
    ]
    # Of those against whom nothing speaks, others each time.
    first = int(state.newest_t) % max(len(found), 1)
    found = found[first:] + found[:first]
    found.sort(key=lambda i: (-bent.get(layout.walks[i].number, 0.0), -_odds(layout.walks[i].node)))
    return found[: MOST if speaks else SOME]


def _told_of(problem: Problem, walk: Walk) -> bool:
    """Whether anything tells of a way beside what its bearer has dropped, and the base where he set out."""
    pairs, fixed, _ = _strange(problem, walk.number)
    return bool(pairs.any() or fixed.any())


def _ranged(problem: Problem, number: int) -> bool:
    """Whether more than powers tell of a way so."""
    pairs, fixed, kinds = _strange(problem, number)
    return bool(fixed.any() or (kinds[pairs] != RSSI).any())


def _strange(problem: Problem, number: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_], Array]:
    """Which readings of pairs and which fixes tell of a way beside its own; and the kinds of the former."""
    state, rows = problem.layout.state, problem.rows
    drops = state.ledger.table("drops")
    own = {number, *drops[drops[:, 2] == number, 1].astype(int).tolist()}
    own |= {node.index for node in state.nodes.values() if node.mode == "fixed"}
    told = rows.of([number])
    strange = ~np.isin(rows.pairs[:, 2:4], list(own)).all(axis=1)
    m, n = len(rows.pairs), len(rows.singles)
    return told[:m] & strange, told[m : m + n] & (rows.singles[:, 2] < 2.0), rows.pairs[:, 1]


def _times(since_s: float, longer: float) -> int:
    """How often it has been asked of a window by the clock that began so long ago (s)."""
    return math.floor(math.log(max(since_s / FIRST_S, 1.0), longer))


def _is_open(node: NodeState) -> bool:
    """Whether it is not decided how somebody's unit is worn, or another one's who takes him along."""
    return any(other.by_unit for other in node.otherwise)


def _speak(state: FusionState, doubted: float = DOUBTED) -> bool:
    """Whether anything speaks against anybody's unit by so much, or did when it was asked last."""
    return any(
        node.mode == "unit" and (_odds(node) > doubted or node.walk_factors[0] > LED_ASTRAY or _is_open(node))
        for node in state.nodes.values()
    )


def _odds(node: NodeState) -> float:
    return -math.inf if node.rival is None else node.rival.odds


def _askable(node: NodeState, walk: Walk) -> bool:
    if walk.way is None or node.index != walk.number or node.mode != "unit" or node.raw:
        return False
    if node.carried_t is not None:
        return False
    return node.apart is None and node.frame_rad == 0.0 and node.changed is None and node.way_m > GONE_M


def _take(state: FusionState, guess: MountingHypothesis) -> None:
    """Go on with units worn as is likeliest: what was learned of anybody a wrong world has made."""
    for number, way in guess.worn:
        mount(state, number, way)
    state.noise = {}
    for node in list(state.nodes.values()):
        if node.mode == "unit":
            state.keep(replace(node, walk_factors=(1.0, 1.0), rival=None))


def _mode(
    guess: MountingHypothesis, best: MountingHypothesis, now: Mapping[int, Mounting], share: float
) -> Mode:
    """Another guess as another solution of the window: who wears a unit otherwise in it goes on otherwise.

    Args:
        guess: the other one.
        best: that which is shown.
        now: how each unit was taken to be worn before.
        share: how likely the other one is.
    """
    number, way = (*guess.worn, *best.worn)[0]
    there, here = dict(guess.worn), dict(best.worn)
    images = {
        n: there.get(n, now[n]).after(here.get(n, now[n]).back()).image for n in sorted({*there, *here})
    }
    return Mode(number, share, guess.x, ALWAYS, way.image, images)


def _kept(layout: Layout, x: Array) -> list[Mode]:
    """What was open when it was asked last, where it is not asked now: who goes on otherwise has done so."""
    size, now = layout.length * layout.width, (layout.length - 1) * layout.width
    at = {walk.number: now + STATES * i for i, walk in enumerate(layout.walks)}
    at |= {number: size + start for number, start in layout.stands.items()}
    found: dict[tuple[int, float, Image], tuple[Mode, dict[int, Image]]] = {}
    for node in layout.state.nodes.values():
        for other in node.otherwise if node.index in at else ():
            if other.by_unit:
                images = dict[int, Image]()
                mode = Mode(other.of, other.share, x.copy(), ALWAYS, other.way, images)
                mode, images = found.setdefault(other.mode, (mode, images))
                own = slice(at[node.index], at[node.index] + 2)
                mode.x[own] = other.image.of(x[own])
                if other.image.flip < 0.0 or other.image.cosine < 1.0:
                    images[node.index] = other.image
    return [mode for mode, _ in found.values()]


def _tell(state: FusionState) -> None:
    """Say whose units seem to be worn the wrong way round."""
    for node in list(state.nodes.values()):
        way = mounting_of(node)
        if way != RIGHT:
            how = "mirrored" if way.mirrored else f"turned by {round(math.degrees(way.turned_rad)) % 360}°"
            why = "" if way.mirrored else ", or faced elsewhere at first than was told"
            seems = f"the unit of {node.node} seems to be worn the wrong way round{why}"
            text = f"{seems}: what it reports is {how}"
            state.say("conflict", state.newest_t, node.node, text, once=f"{node.node} worn {how}")
