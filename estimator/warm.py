"""Has the inner loops compiled before the first incident needs them: numba takes seconds, once a machine."""

import numpy as np

from estimator.fusion.entering.modes import UndecidedNode, costs_of, find_modes, short_costs
from estimator.fusion.learned.gyros import prior_sigma_radps
from estimator.fusion.learned.link_correlation import NEW
from estimator.fusion.learned.noise import single_sigma
from estimator.fusion.learned.reach import UNTOLD, follow
from estimator.fusion.learned.rival import predicted
from estimator.fusion.learned.unit_rise import rises_of
from estimator.fusion.memory.ledger import COLUMNS
from estimator.fusion.motion.constant_velocity import free_motion
from estimator.fusion.motion.dead_reckoning import walk
from estimator.fusion.motion.heading_arcs import arcs_m2, swung_m2
from estimator.fusion.motion.recent_places import TrailEnd, offset, turned_m
from estimator.fusion.motion.silence import gone_m2, unheard_m2, went_on
from estimator.fusion.readings.crossings import crossings_in
from estimator.fusion.readings.echoes import tell as tell_echoes
from estimator.fusion.readings.pair_rows import PAIR, Technology, pair_rows
from estimator.fusion.report import shown, widen
from estimator.fusion.rows import rival_kernels
from estimator.fusion.rows.range_curvature import arc_error
from estimator.fusion.rows.rows import FIELDS, ONE
from estimator.fusion.update import ask_and_take_in
from estimator.graph.assembly import add_motion, add_part, couple, localise
from estimator.graph.chain_kernels import eliminate, selected_inverse, substitute, take_off
from estimator.graph.dense import factorise, inverse
from estimator.graph.gauge import Turning, change_pairs, pivot, turn_pairs, turned_along, turning
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.right_sides import carry, carry_back
from estimator.graph.robust import cauchy_cost, mixture_cost, prior_cost, total_cost, weigh
from estimator.graph.scatter import ROW, scatter_rows
from estimator.graph.shared_errors import eliminate_shared, sharing
from estimator.graph.symmetric import full
from estimator.graph.triangular import inverted
from estimator.graph.variable import Variable
from estimator.inertial.after_gaps import find_standstill, keep_heading
from estimator.inertial.after_gaps import level_backwards as place_boot
from estimator.inertial.boot import Boot
from estimator.inertial.footholds import due_s, move_prints, place_at
from estimator.inertial.free_navigation import add_doubt
from estimator.inertial.sample_rate import Clock, add_epoch
from estimator.inertial.stuck_sensor import drop_stuck_samples, initial_watch
from estimator.inertial.zupt_aided import advance
from estimator.measurements.bearing import predict_bearing, wrap
from estimator.measurements.range import predict_range
from estimator.measurements.rssi import predict_rssi
from estimator.smoothing.changes.moved_nodes import by_node, test_place
from estimator.smoothing.changes.track_fit import RangedTrack, fit_track
from estimator.smoothing.keyframes.displacement_sums import Way, ways_of
from estimator.smoothing.keyframes.ends import Table, faced, place_ends
from estimator.smoothing.keyframes.ground import Ground, Nodes
from estimator.smoothing.keyframes.losses import Losses, mark_heard
from estimator.smoothing.keyframes.walks import STATES, dead_reckon, inverses, misfit, reckon, unit_motion
from estimator.smoothing.learning.delay_scores import (
    PROBES,
    cross_information,
    lag_one_correlation,
    probe,
    scores_by_half,
)
from estimator.smoothing.learning.unit_noise import noise_scores
from estimator.smoothing.learning.wrong_steps import disturbance_covariance, gains
from estimator.smoothing.problem.gauge_turn import moved_from, turn_between
from estimator.smoothing.readings.bodies import ahead
from estimator.smoothing.readings.curvature import BentPairs, NormalMatrix, Numbers, add_curvature
from estimator.smoothing.readings.linearisation import (
    Readings,
    add_reckoning_noise,
    jacobians,
    residuals,
    scale_sigmas,
    separations,
)
from estimator.smoothing.readings.obstructed import excess
from estimator.smoothing.readings.shadows import take_shadows
from estimator.smoothing.readings.sharing import powers_sharing, sharing_counts
from estimator.smoothing.readings.stacked import scattered, sigmas
from estimator.smoothing.readings.thinning import once_a_second
from estimator.smoothing.readings.window_readings import LedgerRows, window_readings
from estimator.smoothing.units.frame_turns import ToldWay, turn_gains
from estimator.smoothing.units.heard_powers import HEARD, power_costs


def warm_up() -> None:
    """Call each compiled function once, with arrays of the kinds that it is called with."""
    _warm_chain()
    _warm_filter()
    one, place = np.ones(2), np.zeros((2, 3))
    strided = np.full((2, 3), 0.5).T
    for too_long in (one, strided[1]):
        tell_echoes(np.zeros((2, 3)), too_long, one)
    for states in ((one, one), (strided[0], strided[1])):
        predict_range(place, place, *states)
    for exponent in (one, strided[1]):
        predict_rssi(one, place, place, one, exponent)
    boot, rests = Boot.new(0.0), np.zeros((60, 3)) + np.array([0.0, 0.0, 9.8])
    taken = advance(boot, rests, np.zeros((60, 3)), 0.01)
    advance(boot, rests[taken:], np.zeros((60, 3))[taken:], 0.01)
    due_s(boot.footholds)
    move_prints(boot.footholds, place_at(boot.footholds, 0.0))
    add_doubt(boot, 0.5)
    keep_heading(boot)
    again, felt = boot.to_level_again(), np.hstack([rests, np.zeros((60, 3))])
    place_boot(again, felt, find_standstill(again, felt, 0.01), 0.01)
    clock = add_epoch(Clock.new(100.0)._replace(counted=1), 1.0, 100.0, overlaps=False)
    add_epoch(clock._replace(counted=1), 1.01, 100.0, overlaps=False)
    drop_stuck_samples(initial_watch(), np.zeros((0, 6)), np.zeros((2, 6)), 0, 0.01)
    predict_bearing(place, place, one)
    wrap(one)
    for noise in (strided, strided.copy()):
        # Of one reading alone the columns of a table lie as those of an array do.
        weigh(one, one, one, *noise)
        mixture_cost(one, one, *noise)
    cauchy_cost(one, 1.0)
    total_cost(np.zeros(0, dtype=np.int64), one)
    prior_cost(one, np.zeros(1, dtype=np.intp), one, one)
    find_modes(UndecidedNode("range", place, one, one, 0.0, 1.0, np.zeros(2), np.eye(2)))


def _warm_chain() -> None:
    """On the smallest chain there is."""
    k, n, s = 2, STATES, 1
    diagonal, link = np.zeros((k, n, n)) + np.eye(n), np.zeros((k - 1, 1, n, n))
    wide, corner, rest = np.zeros((k, n, s + 1)), np.ones((s, s)), np.zeros(s)
    slab, columns = np.zeros(1, dtype=np.int64), np.zeros((1, ROW), dtype=np.int64)
    one, x = np.ones(1), np.zeros(n)
    couple(columns, n, n, np.zeros(1, dtype=np.int64), np.zeros((1, s), dtype=np.bool_))
    localise(columns, n, n, slab, np.zeros((2, n + s), dtype=np.int64))
    linear = slab, columns, np.zeros((1, ROW)), one, one, diagonal, wide, corner, rest
    scatter_rows(slab, *linear)
    eliminate_shared(sharing(slab, slab, 0), *linear)
    take_shadows(sharing(slab, slab, 0), one, np.zeros((1, 3)), one.copy())
    sharing_counts(one)
    between, states = np.zeros((1, 12)), np.zeros((k, n))
    motion = unit_motion(between, one, states)
    misfit(motion)
    doubt = disturbance_covariance(motion, np.zeros((k, 1, n, n)), np.zeros((k - 1, 1, n, n)), 0, 0)
    noise_scores(motion, doubt, np.ones(1, dtype=np.bool_))
    gains(motion, doubt)
    inverses(motion.noise)
    for wide_states in (states, np.zeros((k, 2 * n))[:, :n]):
        reckon(wide_states, between, one, 0)
    for m in (1, k):
        # Of one moment alone the columns of a table lie as those of an array do.
        dead_reckon(states[:m], np.zeros((m, 12))[:, :3], np.zeros((m, 12))[:, 3:6], np.ones(m))
    add_motion(0, 0, motion.transition, motion.information, motion.residual, diagonal, link, wide)
    eliminate(0, k, diagonal, link, wide)
    take_off(0, k, wide, corner.copy(), rest.copy())
    for right in (np.zeros((k, n, 2)), np.zeros((k, n, 2))[:, :, ::2], np.zeros((k, n, 2), order="F")):
        carry(diagonal, link, wide, right, np.zeros((s, right.shape[2])))
        carry_back(diagonal, link, wide, right, np.zeros((s, right.shape[2])))
    substitute(diagonal, link, wide, rest, np.zeros((k, n)))
    add_part(slab, corner, rest, corner, rest)
    selected_inverse(diagonal, link, wide, corner, np.zeros((k, 1, n, n)), np.zeros((k - 1, 1, n, n)))
    place = np.zeros((1, 3))
    end = Table(slab, np.zeros((1, STATES), dtype=np.int64), place, place, place, one)
    place_ends(end, x)
    four = np.zeros((1, 4), dtype=np.int64)
    pair, no = np.zeros((1, 2), dtype=np.int64), np.zeros(1, dtype=np.bool_)
    way = Way(0.0, between, (1.0, 1.0))
    way.between(one, one)
    ground = Ground(
        Nodes(slab, slab, slab, place), np.arange(2.0), np.zeros((2, 1)), pair, ways_of([0], [way])
    )
    heard, read, laid = (np.zeros((1, len(COLUMNS[name]))) for name in ("pairs", "singles", "drops"))
    lost = Losses(slab, slab, 0.0, 1.0, np.zeros((2, 1, 1, 1), dtype=np.int64))
    mark_heard(heard, 0.0, lost)
    found = window_readings(LedgerRows(heard, read, laid), 0.0, ground, pair, lost, no, slab)
    ahead(heard, slab, ground, no, states, place)
    rows = found.rows
    readings = Readings(slab, one, one, four, one, one, end, end, slab, one, pair, one, end, end, end, slab)
    jacobian, numbers = np.zeros((5, ROW)), faced(x, slab)
    residuals(readings, numbers, 0, 5, np.zeros(5))
    jacobians(readings, numbers, 0, 5, jacobian)
    add_reckoning_noise(jacobian, place, place, place, place, np.ones(5))
    separations(readings, x)
    scale_sigmas(readings, x, no, True, no, one, one, one)
    excess(slab, one, one, one)
    once_a_second(one, slab, one)
    powers_sharing(heard, one, no)
    for alike in (one, np.ones((2, 2))[:, 0]):
        costs_of(one, one, place, no, alike)
    short_costs(one, one)
    nowhere = np.full((1, 2), -1)
    scores_by_half(nowhere, one, one, 1)
    cross_information(np.zeros((1, 2)), n, n, columns, slab, np.zeros((1, ROW)), one, nowhere, nowhere)
    probe(np.zeros((n, PROBES)), n, n, columns, slab, np.zeros((1, ROW)), one)
    lag_one_correlation(slab, one)
    _, of_node = by_node(slab, heard, 1)
    test_place(of_node, heard, 0, 0, one, one, 0.0)
    fit_track(
        RangedTrack(place[:, :2].copy(), one, one, one, place),
        place[:, :2].copy(),
        True,
        np.zeros(3),
        np.eye(3),
    )
    power_costs(heard, one, one, 0.0, one)
    told = ToldWay(0.0, np.zeros((1, 4)), np.zeros((1, STATES)), np.zeros((1, 4)), one)
    turn_gains(np.ones((1, HEARD)), told, 1.0, np.ones((2, 2)))
    scattered(place, rows, slab, no)
    sigmas(rows.nominal, rows.nominal, rows)
    turned_by = turn_between(place[:, :2], place[:, :2], place[:, 0].copy())
    turning(turned_by)
    moved_from(x, x, pair, pair, place[0, :2], turned_by)
    turn_pairs(x, pair, place[0, :2], 0.0)
    change_pairs(np.eye(2), one, pair, turned_along(x, x, pair, place[0, :2]))
    pivot(np.eye(len(x)), x, Turning(pair, pair, pair[0]), place[0, :2])
    matrix = NormalMatrix(diagonal, wide, corner[None])
    bent = BentPairs(readings.kind, readings.extra, readings.a, readings.b)
    add_curvature(bent, slab, faced(x, slab), one, True, Numbers(slab, columns), matrix)


def _warm_filter() -> None:
    """On the smallest Kirchhoff state there is."""
    graph = Kirchhoff()
    graph.add_node(Variable("position", ""), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    rows, straight = np.arange(3)[None], np.eye(3)[None]
    graph.advance(rows, graph.reference[rows], straight, straight)
    graph.add_measurements(rows, np.ones((1, 3)), np.ones(1), np.zeros(1))
    none_loose = np.zeros(0, dtype=np.intp)
    shown(np.zeros(1, dtype=np.intp), graph.reference, inverse(factorise(graph.information)), none_loose)
    inverted(graph.storage()[0], np.eye(3))
    swung_m2(np.zeros((1, 2, 1)), np.ones(1))
    arcs_m2(np.zeros((1, 2)), np.ones(1))
    arc_error(np.ones(1))
    turned_m((0.0, 0.0, 0.0))
    unheard_m2(1.0, 0.0)
    gone_m2(1.0, 1.0, 1.0, 0.0)
    went_on(1.0)
    single_sigma(1.0, 1.0, 1.0)
    free_motion("responder", 1.0)
    prior_sigma_radps(0.0, 0.0, np.ones((1, 2)))
    rises_of(np.ones((1, 5)), 0.0, 1.0)
    table = np.full((1, FIELDS), 0.5)
    table[0, :2] = ONE, 0.0
    newest = np.array([NEW])
    told, sums, nobody = np.empty((1, 3)), np.zeros((1, 6)), rival_kernels.units_from([], [])
    ask_and_take_in(
        table,
        np.zeros(1),
        nobody,
        *graph.storage(),
        graph.size,
        graph.turning(),
        np.zeros(2),
        newest,
        told,
        sums,
        1,
    )
    crossings_in(table, told, newest, 0)
    follow(np.array(UNTOLD), np.ones(1), np.ones(1), np.ones((1, len(UNTOLD))), np.ones((1, len(UNTOLD))))
    graph.add_node(Variable("unit", ""), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    step = np.array([[0.0, 3.0, *(1.0,) * 10]])
    walk(step, *graph.storage(), graph.size, np.empty(6, dtype=np.intp), np.empty((6, 6)))
    ends, marks = np.zeros((1, len(TrailEnd._fields))), np.zeros((2, 4))
    offset(ends[0], marks, graph.reference, 0.0)
    technology = np.zeros((1, len(Technology._fields)))
    pair_rows(np.zeros((1, PAIR)), technology, ends, marks, newest, graph.reference)
    predicted(np.zeros(4), full(np.ones(10)), 1.0)
    widen(graph.covariance(), 0, 1.0)


if __name__ == "__main__":
    warm_up()
