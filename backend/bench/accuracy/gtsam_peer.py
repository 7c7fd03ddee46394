"""The peer: GTSAM on the same readings, iSAM2 online and Levenberg-Marquardt over all smoothed.

Two-dimensional: a `Pose2` each second of each responder, chained by displacements; breadcrumbs where they
are dropped, to half a metre; ranges and RSSI with Cauchy noise. Heights are not estimated, and drones, which
are known by their height above all, are left out. iSAM2 has its default parameters but for `relinearizeSkip`,
1; Levenberg-Marquardt starts from where it ends.

RSSI is in dB, with P0 and n as a state, in the batch and in iSAM2; but where there is much of it among
breadcrumbs, iSAM2 takes it as a range by the fixed law of `least_squares`. A factor in dB is a Python
function, and iSAM2 asks for it so often that paper A's scenario takes 15 times as long (for 3.1 m RMSE of 4
seeds either way), and long ones hours. What the runs take is no measure of GTSAM's speed for that reason.
"""

import math
import time
from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np

from backend.bench.accuracy.gtsam_factors import Factors
from backend.bench.accuracy.gtsam_graph import Graph
from backend.bench.accuracy.gtsam_nodes import Pose, Walker
from backend.bench.accuracy.least_squares import point
from estimator.estimate import TrackPoint
from estimator.measurements import Drop, Rssi
from estimator.simulate import Report
from estimator.simulate.base import FloatArray

Tracks = dict[str, list[TrackPoint]]

MOST_IN_DB = 2_500
"""So many RSSI readings iSAM2 takes in dB among breadcrumbs; its time grows with their square."""

GIVE_UP_S = 300.0
"""Processor time for which iSAM2 may work (s); what it takes grows with the square of the way, or worse."""

ITERATIONS = 25
RELATIVE_REST = 1e-4
"""Coarser than GTSAM's default, 1e-5 and 100 iterations, which change centimetres."""


class Incremental:
    """`Graph`, solved by iSAM2.

    Args:
        in_db: as `Graph` takes it.
    """

    def __init__(self, in_db: bool = True) -> None:
        self.factors = Factors()
        self.graph = Graph(self.factors, self._pose_of, in_db)
        gtsam = self.factors.gtsam
        parameters = gtsam.ISAM2Params()
        parameters.relinearizeSkip = 1
        self.isam = gtsam.ISAM2(parameters)
        self._began_s = time.process_time()

    def settle(self) -> None:
        """Solve with what has been added since the last time, and begin what can now be begun.

        Raises:
            RuntimeError: the system has no single solution, or it takes too long.
        """
        if time.process_time() - self._began_s > GIVE_UP_S:
            raise RuntimeError(f"iSAM2 has not come to the end in {GIVE_UP_S:g} s")
        while True:
            self.graph.retry()
            factors, values = self.graph.take_new()
            if factors.size() == 0:
                return
            self.isam.update(factors, values)
            for node in self.graph.begun():
                pose = self.isam.calculateEstimatePose2(node.key)
                node.pose = (pose.x(), pose.y(), pose.theta())

    def _pose_of(self, key: int) -> Pose | None:
        if not self.isam.valueExists(key):
            return None
        pose = self.isam.calculateEstimatePose2(key)
        return pose.x(), pose.y(), pose.theta()

    def shown(self, walker: Walker) -> TrackPoint | None:
        """Where a responder is: its newest pose, reckoned on to its newest displacement."""
        if walker.pose is None:
            return None
        t = walker.t_s[-1]
        covariance = self.isam.marginalCovariance(walker.key)
        return _point(t, self.graph.place(walker, t), walker.pose[2], covariance, walker.up_m)


def online(reports: Sequence[Report]) -> Tracks:
    """The estimates as they stand at each whole second.

    Raises:
        RuntimeError: iSAM2 gave up.
    """
    peer, tracks = Incremental(_in_db(reports)), Tracks()
    for _, posted in groupby(reports, key=lambda report: math.ceil(report.sent_s)):
        for report in posted:
            peer.graph.take(report.reading)
        peer.settle()
        for name, walker in peer.graph.walkers.items():
            track = tracks.setdefault(name, [])
            if walker.begun and (not track or track[-1].t != walker.t_s[-1]):
                shown = peer.shown(walker)
                track += [] if shown is None else [shown]
    return tracks


def smoothed(reports: Sequence[Report]) -> Tracks:
    """Every pose, by Levenberg-Marquardt over all factors, from where iSAM2 ends.

    iSAM2 gets the readings in order of epoch here: nothing is late when everything is known.

    Raises:
        RuntimeError: iSAM2 or the batch gave up.
    """
    peer = Incremental(_in_db(reports))
    in_order = sorted(reports, key=lambda report: report.reading.t)
    for _, posted in groupby(in_order, key=lambda report: math.ceil(report.reading.t)):
        for report in posted:
            peer.graph.take(report.reading)
        peer.settle()
    gtsam = peer.factors.gtsam
    everything, start = peer.graph.everything, peer.isam.calculateEstimate()
    if peer.graph.hears and not start.exists(peer.factors.path_loss):
        start.insert(peer.factors.path_loss, peer.factors.path_loss_guess())
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setMaxIterations(ITERATIONS)
    parameters.setRelativeErrorTol(RELATIVE_REST)
    solved = gtsam.LevenbergMarquardtOptimizer(everything, start, parameters).optimize()
    marginals = gtsam.Marginals(everything, solved)
    tracks = Tracks()
    for name, walker in peer.graph.walkers.items():
        for index in range(walker.sent):
            key = walker.first_key + index
            pose = solved.atPose2(key)
            place = (pose.x(), pose.y(), pose.theta())
            t = walker.t_s[walker.poses[index]]
            covariance = marginals.marginalCovariance(key)
            tracks.setdefault(name, []).append(_point(t, place, place[2], covariance, walker.up_m))
    return tracks


def _in_db(reports: Sequence[Report]) -> bool:
    """Whether iSAM2 can take RSSI in dB: without breadcrumbs poses have few others to agree with."""
    readings = [report.reading for report in reports]
    many = sum(isinstance(reading, Rssi) for reading in readings) > MOST_IN_DB
    return not many or not any(isinstance(reading, Drop) for reading in readings)


def _point(t: float, place: Pose, turn_rad: float, covariance: Any, up_m: float) -> TrackPoint:
    """A point of a track; GTSAM gives the covariance along the pose's own axes."""
    cosine, sine = math.cos(turn_rad), math.sin(turn_rad)
    turn: FloatArray = np.array([[cosine, -sine], [sine, cosine]])
    return point(t, np.array(place[:2]), turn @ np.asarray(covariance)[:2, :2] @ turn.T, up_m)
