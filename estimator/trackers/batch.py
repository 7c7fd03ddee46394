"""The smoothed view: the whole incident solved again with everything known now (`smoothing.whole`)."""

from estimator.estimate import TrackPoint
from estimator.evidence import Advice, Evidence
from estimator.fusion.memory.state import FusionState
from estimator.smoothing.images.alternatives import Mode, widen
from estimator.smoothing.images.flip_ambiguity import WHOLE
from estimator.smoothing.images.likeliest_image import likeliest_image
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.results.advice import advise
from estimator.smoothing.results.calibration_doubt import doubt_scales, doubt_suspected
from estimator.smoothing.results.evidence import explain
from estimator.smoothing.results.heading_arcs import widen_by_arcs
from estimator.smoothing.results.late_starts import doubt_starts
from estimator.smoothing.results.tracks import tracks
from estimator.smoothing.whole import solve_whole
from estimator.trackers.base import Told, TrackerSettings
from estimator.trackers.heard import Heard


class BatchSmoother:
    """Solves a whole incident; see `estimator.trackers.base.Smoother`."""

    def __init__(self, settings: TrackerSettings | None = None) -> None:
        self.settings = settings or TrackerSettings()

    def smooth(self, told: Told) -> dict[str, list[TrackPoint]]:
        """Every node's track, a point at each whole second from its first to its last reading.

        Nodes whose position is never decided have no track.
        """
        state, lifetimes = self._heard(told).ended()
        if not lifetimes:
            return {}
        problem, solved, modes = _likeliest(state)
        solved.chain.reduce()
        covariances = solved.chain.covariances()
        widen_by_arcs(problem.layout, solved, covariances)
        doubt_scales(problem.layout, solved, covariances)
        doubt_suspected(problem, solved, covariances)
        widen(problem.layout, solved.x, modes, covariances)
        doubt_starts(problem.layout, covariances)
        return tracks(problem.layout, solved.x, *covariances, lifetimes)

    def evidence(self, told: Told, node: str) -> Evidence | None:
        """What holds a node's newest fix; see `estimator.smoothing.results.evidence.explain`.

        Raises:
            KeyError: there is no such node.
        """
        state, _ = self._heard(told).ended()
        if state.nodes[node].mode == "fixed":
            return None
        problem, solved, modes = _likeliest(state)
        return explain(problem.layout.state, problem, solved, modes, node)

    def advice(self, told: Told, node: str) -> Advice | None:
        """What would help a node most; see `estimator.smoothing.results.advice.advise`.

        Raises:
            KeyError: there is no such node.
        """
        state, _ = self._heard(told).ended()
        return advise(state, node)

    def _heard(self, told: Told) -> Heard:
        if isinstance(told, Heard):
            return told
        heard = Heard(self.settings.lag_s, self.settings.origin_wgs84)
        heard.hear(told)
        return heard


def _likeliest(state: FusionState) -> tuple[Problem, Solution, list[Mode]]:
    """Everything solved, and others that are as likely."""
    problem, solved, others = solve_whole(state)
    problem, solved, modes, *_ = likeliest_image(problem, solved, WHOLE)
    return problem, solved, [*modes, *others]
