"""The smoothed view: the whole incident solved again with everything known now (`smoothing.whole`)."""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence

from estimator.estimate import TrackPoint
from estimator.evidence import Advice, Evidence
from estimator.fusion.canonical_order import UNTIL_T, place_of
from estimator.fusion.holding import names_of
from estimator.inertial.samples import AnyFolded, in_pieces
from estimator.measurements import AnyReading
from estimator.smoothing.images.alternatives import widen
from estimator.smoothing.images.flip_ambiguity import WHOLE
from estimator.smoothing.images.likeliest_image import likeliest_image
from estimator.smoothing.results.advice import advise
from estimator.smoothing.results.calibration_doubt import doubt_scales, doubt_suspected
from estimator.smoothing.results.evidence import explain
from estimator.smoothing.results.heading_arcs import widen_by_arcs
from estimator.smoothing.results.tracks import tracks
from estimator.smoothing.whole import first_pass, solve_whole
from estimator.trackers.base import TrackerSettings

LONGEST_S = 86_400.0
"""No incident lasts longer: a reading farther than a day from the others has a wrong epoch."""


class BatchSmoother:
    """Solves a whole incident; see `estimator.trackers.base.Smoother`."""

    def __init__(self, settings: TrackerSettings | None = None) -> None:
        self.settings = settings or TrackerSettings()

    def smooth(self, readings: Sequence[AnyReading]) -> dict[str, list[TrackPoint]]:
        """Every node's track, a point at each whole second from its first to its last reading.

        Nodes whose position is never decided have no track.
        """
        ordered = in_order(readings)
        if not ordered:
            return {}
        state = first_pass(ordered, self.settings.origin_wgs84)
        problem, solved, others = solve_whole(state)
        problem, solved, modes, *_ = likeliest_image(problem, solved, WHOLE)
        solved.chain.solve()
        covariances = solved.chain.covariances()
        widen_by_arcs(problem.layout, solved, covariances)
        doubt_scales(problem.layout, solved, covariances)
        doubt_suspected(problem, solved, covariances)
        widen(problem.layout, solved.x, [*modes, *others], covariances)
        return tracks(problem.layout, solved.x, *covariances, lifetimes(ordered))

    def evidence(self, readings: Sequence[AnyReading], node: str) -> Evidence | None:
        """What holds a node's newest fix; see `estimator.smoothing.results.evidence.explain`.

        Raises:
            KeyError: there is no such node.
        """
        state = first_pass(in_order(readings), self.settings.origin_wgs84)
        if state.nodes[node].mode == "fixed" or not len(state.ledger.table("begins")):
            return None
        problem, solved, others = solve_whole(state)
        problem, solved, modes, *_ = likeliest_image(problem, solved, WHOLE)
        return explain(problem.layout.state, problem, solved, [*modes, *others], node)

    def advice(self, readings: Sequence[AnyReading], node: str) -> Advice | None:
        """What would help a node most; see `estimator.smoothing.results.advice.advise`.

        Raises:
            KeyError: there is no such node.
        """
        return advise(first_pass(in_order(readings), self.settings.origin_wgs84), node)


def in_order(readings: Sequence[AnyReading]) -> list[AnyFolded]:
    """The readings in canonical order, without those whose epoch must be wrong."""
    ordered = sorted(in_pieces(readings), key=place_of)
    middle = ordered[len(ordered) // 2].until_t if ordered else 0.0
    first = bisect_right(ordered, middle - LONGEST_S, key=UNTIL_T)
    return ordered[first : bisect_left(ordered, middle + LONGEST_S, key=UNTIL_T)]


def lifetimes(readings: Sequence[AnyFolded]) -> dict[str, tuple[float, float]]:
    """First and last epoch of each node's readings, which come in order of epoch."""
    first: dict[str, float] = {}
    last: dict[str, float] = {}
    for reading in readings:
        since_t, until_t = reading.t, reading.until_t
        for name in names_of(reading):
            last[name] = until_t
            if name not in first or since_t < first[name]:
                first[name] = since_t
    return {name: (t, last[name]) for name, t in first.items()}
