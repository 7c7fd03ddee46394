"""One tick's readings, all at once, into the Kirchhoff state; what they tell of the noise is learned."""

import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.fusion.entering.reinitialise import check_ranges
from estimator.fusion.entering.technologies import REACH
from estimator.fusion.learned.link_correlation import DRIFTS, ERROR, KEPT, SAME_PLACE
from estimator.fusion.learned.noise import near_dbm
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.unreliable_unit import NOBODY, answer, ask
from estimator.fusion.readings import echoes
from estimator.fusion.readings.crossings import learn_reach
from estimator.fusion.rows.gauge_turn import undo_turn
from estimator.fusion.rows.gauss_newton import (
    GOOD,
    INDEFINITE,
    PREDICTED,
    RESIDUAL,
    SOLVED,
    Minimum,
    minimise,
)
from estimator.fusion.rows.prediction import Prediction, follow, predict
from estimator.fusion.rows.rival_kernels import RivalUpdate, Units, update_rivals
from estimator.fusion.rows.rows import CONSTANT, EXTRA, KIND, LINK, NOMINAL, OUTLIERS, SIGMA, SOURCE, VALUE
from estimator.graph.dense import Array
from estimator.graph.filter_kernels import scatter
from estimator.graph.gauge import Turning

LEVER_M = 20.0
"""A heading's error at the far end of a room's way."""
ITERATIONS = 6
Taken = tuple[int, float, bool, int]
"""What has come of readings that were taken in, see `take_in`."""


def update(state: FusionState, table: Array, epochs: Array) -> None:
    """Add measurements (operation 1 of paper A, eq. 18) and solve (eq. 4), relinearised where h is curved.

    Before they are added they are asked whose ways foretell them (`motion.unreliable_unit`).

    Args:
        state: the fusion; its graph is solved and rests at the new estimate afterwards. Readings that make no
            solvable system are left out.
        table: the readings, see `rows.table_of`.
        epochs: theirs, m (s).
    """
    if len(table) == 0:
        return
    told, sums, asked = np.empty((len(table), 3)), np.zeros((len(state.sources), 6)), ask(state, table)
    taken, rivals = _hold(state, table, epochs, asked.told, told, sums)
    if taken[0] == INDEFINITE:
        state.graph.mend()
        taken, _ = _hold(state, table, epochs, NOBODY.told, told, sums)
    answer(state, asked, rivals)
    outcome, turned_rad, again, outliers = taken
    if outcome != SOLVED:
        return
    state.bent_m += LEVER_M * turned_rad
    # Who passes a kicked breadcrumb is held back by it, or hears it too far off again and again: its window
    # is not to wait.
    if again:
        state.suspected = True
    check_ranges(state, table, told[:, GOOD])
    state.count("outlier", outliers)
    _learn(state, table, told, sums)


def _hold(
    state: FusionState, table: Array, epochs: Array, units: Units, told: Array, sums: Array
) -> tuple[Taken, RivalUpdate]:
    graph = state.graph
    changed, base_m = graph.turning(state.landmarks()), np.array(state.base_place()[:2])
    newest = state.links.table
    return ask_and_take_in(
        table, epochs, units, *graph.storage(), graph.size, changed, base_m, newest, told, sums, ITERATIONS
    )


def _learn(state: FusionState, table: Array, told: Array, sums: Array) -> None:
    """M-step for the noise of each technology: what good readings are off, and how unsure that is itself."""
    learn_reach(state, table, told)
    for source, more in zip(state.sources, sums.tolist(), strict=True):
        if more[4] > 0.0 and source != REACH:
            state.noise[source] = state.learned(source).with_errors(*more, t=state.newest_t)


@njit(cache=True, error_model="numpy", nogil=True)
def ask_and_take_in(
    table: Array,
    epochs: Array,
    units: Units,
    matrix: Array,
    vector: Array,
    reference: Array,
    n: int,
    changed: Turning,
    base_m: Array,
    links: Array,
    told: Array,
    sums: Array,
    iterations: int,
) -> tuple[Taken, RivalUpdate]:
    """Ask readings of units, then take them in: what is known of them before is worked out once for both.

    Args:
        table: of m readings, at least one.
        epochs: theirs, m (s).
        units: of which they are asked.
        matrix: see `take_in`.
        vector: the same.
        reference: the same.
        n: the same.
        changed: the same.
        base_m: the same.
        links: the same.
        told: the same.
        sums: the same.
        iterations: the same.
    """
    seen = predict(table, matrix, vector[:n], reference[:n])
    rivals = update_rivals(table, epochs, units, seen, reference[:n])
    taken = take_in(table, seen, matrix, vector, reference, n, changed, base_m, links, told, sums, iterations)
    return taken, rivals


@njit(cache=True, error_model="numpy", nogil=True)
def take_in(
    table: Array,
    seen: Prediction,
    matrix: Array,
    vector: Array,
    reference: Array,
    n: int,
    changed: Turning,
    base_m: Array,
    links: Array,
    told: Array,
    sums: Array,
    iterations: int,
) -> Taken:
    """Add readings to a Kirchhoff state and let it rest at the new estimate; sum up what they tell of noise.

    Args:
        table: of m readings.
        seen: what is known of them before.
        matrix: L, n × n or larger, changed.
        vector: b, as long, changed.
        reference: x, as long, changed.
        n: rows in use.
        changed: which of its numbers change when the map is turned.
        base_m: east and north of the base, 2 (m).
        links: the newest reading on each link, see `tally`; changed.
        told: takes what each reading was off by, the variance of its prediction and the probability that it
            is good, m × 3: `RESIDUAL`, `PREDICTED`, `GOOD`.
        sums: see `tally`.
        iterations: how often to relinearise at most.

    Returns:
        The outcome, see `gauss_newton.Minimum`: unless it is `SOLVED` nothing has been changed; the largest
        turn of a unit (rad); see `outlier_again`; the number of outliers.
    """
    found = minimise(table, seen, iterations)
    if found.outcome != SOLVED:
        return found.outcome, 0.0, False, 0
    x, turned_rad, jacobian = reference[:n].copy(), 0.0, found.jacobian
    follow(seen, found.x, x)
    if len(changed.headings) > 0:
        # Nobody's steps carry a turn on in a map of who has no unit: radios whose place is known hold it.
        before = reference[:n].copy()
        follow(seen, found.before, before)
        known = matrix, vector[:n], reference[:n]
        jacobian = undo_turn(table, seen.columns, found, before, *known, x, changed, base_m)
    for row in changed.headings:
        turned_rad = max(turned_rad, abs(x[row] - reference[row]))
    scatter(matrix, vector, seen.columns, jacobian, found.information, found.residual)
    vector[:n], reference[:n] = 0.0, x
    for r in range(len(table)):
        told[r, RESIDUAL], told[r, PREDICTED] = found.residual[r], found.predicted[r]
        told[r, GOOD] = found.good[r]
    again = outlier_again(table, found.good, links, found.doubted)
    return found.outcome, turned_rad, again, tally(table, found, x, links, sums)


@njit(cache=True, error_model="numpy")
def outlier_again(table: Array, good: Array, links: Array, doubted: bool) -> bool:
    """Whether a range is an outlier, and the reading before it on its link was one as well.

    Args:
        table: of m readings, see `rows.Row`.
        good: probability that each has the good noise, m.
        links: the newest reading on each link, see `links`; its error is that of the one before.
        doubted: one outlier is enough.
    """
    for r in range(len(table)):
        if good[r] < SAME_PLACE and table[r, KIND] == RANGE:
            link = int(table[r, LINK])
            if doubted or (link >= 0 and links[link, KEPT] > 0.0 and np.isnan(links[link, ERROR])):
                return True
    return False


@njit(cache=True, error_model="numpy")
def tally(table: Array, found: Minimum, x: Array, links: Array, sums: Array) -> int:
    """Sum up what readings tell of the noise of their technologies, and count the outliers among them.

    Args:
        table: of m readings.
        found: what they have led to.
        x: the estimate, n.
        links: the newest reading on each link, see `links`; its error is changed.
        sums: takes count, squares, pairs, products, seen and powers of each technology, as
            `LearnedNoise.with_errors` does.
    """
    outliers = 0
    for r in range(len(table)):
        good, residual = found.good[r], found.residual[r]
        outliers += good < SAME_PLACE
        source, link = int(table[r, SOURCE]), int(table[r, LINK])
        if source < 0:
            continue
        if near_each_other(table[r], residual, x):
            if link >= 0:
                links[link, ERROR] = np.nan
            continue
        nominal, variance = table[r, NOMINAL], table[r, SIGMA] ** 2
        unsure = found.predicted[r] * variance / (found.predicted[r] + variance)
        sums[source, 0] += good
        sums[source, 1] += good * (residual**2 + unsure) / nominal**2
        sums[source, 4] += 1.0
        sums[source, 5] += table[r, KIND] == RSSI
        if link < 0:
            continue
        if table[r, OUTLIERS] == physics.ECHOES:
            echoes.fit(links[link], good)
        error = residual / nominal
        if links[link, KEPT] > SAME_PLACE and not np.isnan(links[link, ERROR]):
            sums[source, 2] += good
            # What a filter with the right noise leaves of one tick tells nothing of the next one.
            apart = 0.0 if table[r, KIND] == RSSI and links[link, DRIFTS] != 0.0 else unsure
            sums[source, 3] += good * (error * links[link, ERROR] - apart / nominal**2)
        links[link, ERROR] = error if good > SAME_PLACE else np.nan
    return outliers


@njit(cache=True, error_model="numpy")
def near_each_other(row: Array, residual: float, x: Array) -> bool:
    """Whether a reading is of a power between radios that are thought to be near each other.

    The direct path rules there: it tells nothing of how noisy radios are that are farther apart.

    Args:
        row: of the reading.
        residual: z − h(x).
        x: the estimate, n.
    """
    extra = int(row[EXTRA])
    if row[KIND] != RSSI or extra < 0:
        return False
    return bool(row[VALUE] - residual >= near_dbm(x[extra] + row[CONSTANT], x[extra + 1]))
