"""Radios whose ranges are all off by the same: an antenna delay that nobody has calibrated.

The map bends until their ranges fit: none of them need stand out. What stands out is the score, all residuals
of a radio together, held against what they would vary by were it like all others (Rao's test; Engle, Wald,
likelihood ratio, and Lagrange multiplier tests in econometrics, 1984). What the map would take up of it were
it solved to the end is none of theirs: where anchors stand close together a tenth of a millimetre is more
than all that tells a delay from a place. With the weights by which outliers count less it promises no more
than there is to gain (Dempster, Laird, Rubin 1977).
"""

import math

import numpy as np

from estimator.fusion import physics
from estimator.fusion.learned.calibration import TRUSTED, bias_sigma_m
from estimator.fusion.learned.delays import Radio, reported_as
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.robust import mixture_cost
from estimator.smoothing.learning.radios import Delay, RangesByRadio, bias_columns, ranges_by_radio
from estimator.smoothing.learning.suspected_delays import suspicions
from estimator.smoothing.learning.trusted_radios import distrust
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

RARE = math.log(physics.DELAYED / (1.0 - physics.DELAYED))
ODDS = math.log(TRUSTED / (1.0 - TRUSTED)) - RARE
"""Log likelihood ratio from which on a radio is not trusted any more."""
CLEARER = 3.0
"""So much likelier it must be than another cause of the same."""
ALIKE = 3.0
"""Radios that readings hardly tell apart from the likeliest one are not trusted either."""
ASKED = 8
"""So many radios are asked at a time, those with the largest residuals, and all of who moves."""
CONSTANT = 0.7
"""What one bias gains of what another one in each half of the time would: a breadcrumb that was kicked, or a
tag that was put down, is off by something else before and after."""
NOISE = 3.0
"""What the latter may gain more by noise alone (log likelihood): such a radio is suspected all the same."""
FARTHEST = 3.0
"""Of the usual deviation: what is off by more is no antenna delay, but a map that is wrong altogether."""
NOTHING = 1e-300
AGAIN, LONGEST_S = 0.5, 60.0
"""It is asked again after this share of the window, or where something is suspicious, with each solution."""


def doubt_delays(state: FusionState, problem: Problem, solved: Solution, other: float) -> None:
    """Trust no radio any longer that is likely to be off: its ranges become a technology by themselves.

    Args:
        state: takes it; its window is then to be solved again.
        problem: of the window.
        solved: its solution.
        other: log odds of the likeliest other cause of what such a radio would do.
    """
    span_s = float(problem.layout.grid[-1] - problem.layout.grid[0])
    if state.newest_t < state.delays_t + min(AGAIN * span_s, LONGEST_S):
        return
    told = ranges_by_radio(problem, solved)
    pulling = scored_delays(problem, solved, told)
    found = _likeliest(pulling, _rejected_radios(problem, solved, told))
    if not found or found[0].odds < 0.0:
        state.delays_t = state.newest_t
    off = doubted(found, max(ODDS, other + CLEARER - RARE))
    state.suspects = suspicions(problem, solved, told, [one for one in pulling if one not in off])
    distrust(state, off)


def doubted(found: list[Delay], least: float = ODDS) -> list[Delay]:
    """Those radios that are not to be trusted.

    Args:
        found: all that may be off, the likeliest first.
        least: log likelihood ratio from which on one is not.
    """
    return [one for one in found if one.odds > max(least, found[0].odds - ALIKE)]


def delay_odds(problem: Problem, solved: Solution) -> dict[str, float]:
    """Log odds that each node's radio is off, whatever it is of.

    Args:
        problem: of a window, or of the whole incident.
        solved: its solution.
    """
    found: dict[str, float] = {}
    for one in delays(problem, solved):
        found.setdefault(one.radio[1], one.odds + RARE)
    return found


def delays(problem: Problem, solved: Solution) -> list[Delay]:
    """How likely each radio is to be off, the likeliest first; those that are known to be are not asked.

    Args:
        problem: of a window, or of the whole incident.
        solved: its solution.
    """
    told = ranges_by_radio(problem, solved)
    return _likeliest(scored_delays(problem, solved, told), _rejected_radios(problem, solved, told))


def _likeliest(pulling: list[Delay], unbelieved: list[Delay]) -> list[Delay]:
    found = {one.radio: one for one in (*pulling, *unbelieved) if one.constant}
    return sorted(found.values(), key=lambda one: -one.odds)


def scored_delays(problem: Problem, solved: Solution, told: RangesByRadio) -> list[Delay]:
    """Delays of the radios with the largest residuals, by the score of a bias less what the map takes up."""
    layout, total = problem.layout, told.told.sum(axis=1)
    size = layout.length * layout.width
    suspicion = told.score.sum(axis=1) ** 2 / np.maximum(total, NOTHING)
    nodes, order = layout.state.nodes, np.argsort(-suspicion, kind="stable").tolist()
    asked = order[:ASKED] + [r for r in order[ASKED:] if nodes[told.radios[r][1]].moving]
    if not asked:
        return []
    right = bias_columns(problem, solved, told, np.array(asked))
    of_keyframes = right[:size].reshape(layout.length, layout.width, right.shape[1])
    solved.chain.reduce()
    taken = solved.chain.explained(of_keyframes, right[size:])
    worth, found = _effective_share(problem, solved, told), []
    for i, radio in enumerate(asked):
        own = slice(2 * i, 2 * i + 2)
        left = np.diag(told.told[radio]) - taken.information[own, own]
        score = told.score[radio] - taken.score[own]
        found.append(delay_of(told.radios[radio], worth[radio] * score, worth[radio] * left))
    return [one for one in found if one is not None]


def _effective_share(problem: Problem, solved: Solution, told: RangesByRadio) -> Array:
    """Information of each radio's ranges, as a share of what independent errors would have; radios.

    What lasts while nobody moves the estimate follows, and no residual shows it: k ranges of variance w that
    share one of c are worth k / (w + k c).
    """
    rows, known, shared_m2 = problem.rows, told.carried >= 0, np.zeros(len(told.ranges))
    sources = rows.pairs[told.ranges, 6].astype(np.intp)
    for source in np.unique(sources).tolist():
        shared_m2[sources == source] = _own_m2(reported_as(problem.layout.state.sources[source]))
    more = 1.0 + rows.alike[told.ranges] * shared_m2 / rows.sigma[told.ranges] ** 2
    weight = solved.weighted.information[told.ranges]
    single, together = (
        np.bincount(told.carried[known], np.repeat(each, 2).reshape(-1, 2)[known], len(told.radios))
        for each in (weight, weight * more)
    )
    return np.asarray(single / np.maximum(together, NOTHING))


def delay_of(radio: Radio, score: Array, left: Array) -> Delay | None:
    """The delay of a radio by the score of its bias; None where that is no antenna delay.

    Args:
        radio: the radio.
        score: of its bias in both halves of the time, 2.
        left: information on both that the map does not take up, 2 × 2.
    """
    usual, wide = _variances_m2(radio)
    information, pulled = max(float(left.sum()), 0.0), float(score.sum())
    known, known_usual = information + 1.0 / wide, information + 1.0 / usual
    gain, bias_m = 0.5 * pulled**2 / known, pulled / known
    apart = 0.5 * float(score @ np.linalg.solve(left + np.eye(2) / wide, score))
    constant = gain >= CONSTANT * apart
    if (not constant and apart - gain > NOISE) or abs(bias_m) > FARTHEST * math.sqrt(wide):
        return None
    odds = gain - 0.5 * pulled**2 / known_usual - _occam_factor(information, usual, wide)
    share = 1.0 / (1.0 + math.exp(-max(odds + RARE, -700.0)))
    square = share * (bias_m**2 + 1.0 / known)
    square += (1.0 - share) * ((pulled / known_usual) ** 2 + 1.0 / known_usual)
    # What is usual is in the bias that its technology may have.
    return Delay(radio, odds, bias_m, constant, max(square - usual, 0.0))


def _rejected_radios(problem: Problem, solved: Solution, told: RangesByRadio) -> list[Delay]:
    """Delays of radios most of whose ranges are outliers, which one constant bias would make good.

    They bend nothing: their scores are nil, and what is to be gained is seen with the map as it is.
    """
    rows, known = problem.rows, told.carried >= 0
    count = np.bincount(told.carried[known], minlength=len(told.radios))
    good = np.broadcast_to(solved.weighted.good[told.ranges, None], known.shape)
    believed = np.bincount(told.carried[known], good[known], minlength=len(told.radios))
    found = []
    for number in np.flatnonzero(believed < 0.5 * count).tolist():
        radio, (at, end) = told.radios[number], np.nonzero(told.carried == number)
        mine = told.ranges[at]
        residual, sigma, noise = solved.linear.residual[mine], rows.sigma[mine], rows.noise[mine].T
        bias_m = float(np.median(residual))
        gain = mixture_cost(residual, sigma, *noise) - mixture_cost(residual - bias_m, sigma, *noise)
        # As many as may share a wall count for no more than that: see `modes.costs_of`.
        gain /= np.sqrt(rows.alike[mine])
        parts = np.bincount(told.half[at, end], gain, minlength=2)
        usual, wide = _variances_m2(radio)
        constant = parts.min() > (1.0 - CONSTANT) * parts.mean()
        if constant and abs(bias_m) < FARTHEST * math.sqrt(wide):
            odds = float(parts.sum()) - 0.5 * bias_m**2 / wide
            odds -= _occam_factor(float((sigma**-2.0).sum()), usual, wide)
            # Its ranges bend nothing: no place is off by what they are off by.
            found.append(Delay(radio, odds, bias_m, constant, 0.0))
    return found


def _variances_m2(radio: Radio) -> tuple[float, float]:
    """Prior variances of the bias of a calibrated radio of a technology, and of one with a delay (m²)."""
    usual = bias_sigma_m(radio[0]) ** 2
    return usual, usual + physics.DELAY_SIGMA_M**2


def _own_m2(technology: str) -> float:
    """Variance of the part of a calibrated radio's bias that is its own, not its technology's (m²)."""
    return (physics.RADIO_BIAS * bias_sigma_m(technology)) ** 2


def _occam_factor(information: float, usual: float, wide: float) -> float:
    """Occam factor of the wide prior of a bias against the usual one, in log likelihood."""
    return 0.5 * math.log((1.0 + wide * information) / (1.0 + usual * information))
