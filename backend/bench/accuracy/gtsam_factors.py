"""The noise models and factors of the GTSAM peer; GTSAM itself is imported only when it is used."""

import importlib
import math
from typing import Any

import numpy as np

from backend.bench.accuracy.least_squares import EXPONENT, P0_DBM, RANGE_SIGMA_M
from backend.errors import CommandRefused
from estimator.measurements import Range, Rssi

STEP_M_PER_ROOT_M = 0.05
STAND_M_PER_ROOT_S = 0.01
TURN_RAD_PER_ROOT_M = math.radians(0.6)
TURN_RAD_PER_ROOT_S = math.radians(0.05)
WALK_M_PER_ROOT_S = 1.0
"""A responder without PDR may go anywhere at a walk."""

RSSI_SIGMA_DB = 6.0
P0_SIGMA_DB = 6.0
EXPONENT_SIGMA = 0.4
ANTENNA_M = 0.3
CAUCHY = 2.0
"""In standard deviations: a residual twice as large as it should be has half its weight."""

Offset = tuple[float, float]
"""From a pose to where its node was at a reading's epoch, in the pose's own axes (m)."""

End = tuple[int, Offset]
"""One end of a reading: the pose's key, and the offset from it."""


class GtsamMissing(CommandRefused):
    """GTSAM is not installed."""


def load() -> Any:
    """The module `gtsam`.

    Raises:
        GtsamMissing: it is not installed.
    """
    try:
        return importlib.import_module("gtsam")
    except ImportError as error:
        raise GtsamMissing(
            "the entrant gtsam needs the development dependency GTSAM: pip install gtsam"
        ) from error


class Factors:
    """Makes factors over `Pose2` states; θ of a responder is the turn of its PDR frame.

    A displacement comes in the unit's frame, in which the reported heading is already applied, so that the
    frame turns by nothing but its error. With θ the body's heading, and the headings' differences between
    poses, the graph is the same up to a change of variable, and the headings' noise would come in twice.
    """

    def __init__(self) -> None:
        self.gtsam = load()
        self.path_loss = self.gtsam.symbol("p", 0)

    def pose(self, east_m: float, north_m: float, turn_rad: float) -> Any:
        """A `Pose2`."""
        return self.gtsam.Pose2(east_m, north_m, turn_rad)

    def prior(self, key: int, pose: Any, sigma_m: float, sigma_rad: float) -> Any:
        """A pose is known."""
        return self.gtsam.PriorFactorPose2(key, pose, self._diagonal(sigma_m, sigma_m, sigma_rad))

    def place(self, key: int, east_m: float, north_m: float, sigma_m: float) -> Any:
        """A fix of a pose's place."""
        noise = self._robust(self.gtsam.noiseModel.Isotropic.Sigma(2, sigma_m))
        return self.gtsam.PoseTranslationPrior2D(key, np.array([east_m, north_m]), noise)

    def step(self, a: int, b: int, delta_m: Offset, way_m: float, span_s: float) -> Any:
        """What a PDR unit moved from one pose to the next.

        Args:
            a: the earlier pose.
            b: the later pose.
            delta_m: displacement in the unit's frame (m).
            way_m: length of the way between them (m).
            span_s: time between them (s).
        """
        sigma_m = STEP_M_PER_ROOT_M * math.sqrt(way_m) + STAND_M_PER_ROOT_S * math.sqrt(span_s)
        turn = math.hypot(TURN_RAD_PER_ROOT_M * math.sqrt(way_m), TURN_RAD_PER_ROOT_S * math.sqrt(span_s))
        return self.between(a, b, delta_m, sigma_m, turn)

    def wander(self, a: int, b: int, span_s: float) -> Any:
        """Without PDR: a random walk."""
        return self.between(a, b, (0.0, 0.0), WALK_M_PER_ROOT_S * math.sqrt(span_s), 0.01)

    def between(self, a: int, b: int, delta_m: Offset, sigma_m: float, sigma_rad: float) -> Any:
        """One pose from another."""
        noise = self._diagonal(sigma_m, sigma_m, sigma_rad)
        return self.gtsam.BetweenFactorPose2(a, b, self.pose(*delta_m, 0.0), noise)

    def range(self, reading: Range, a: End, b: End) -> Any:
        """A range, robust; the offset of `b` is nil, for GTSAM's factor takes one of `a` alone."""
        noise = self._robust(self.gtsam.noiseModel.Isotropic.Sigma(1, reading.sigma_m or RANGE_SIGMA_M))
        return self.gtsam.RangeFactorWithTransformPose2(
            a[0], b[0], reading.range_m, noise, self.pose(*a[1], 0.0)
        )

    def rssi(self, reading: Rssi, a: End, b: End) -> Any:
        """Received power in dB, robust, with P0 and n as the state of `path_loss`."""
        noise = self._robust(self.gtsam.noiseModel.Isotropic.Sigma(1, RSSI_SIGMA_DB))
        (key_a, (ax, ay)), (key_b, (bx, by)) = a, b
        loss, dbm = self.path_loss, reading.dbm

        def error(_: Any, values: Any, jacobians: Any) -> Any:
            pose_a, pose_b, law = values.atPose2(key_a), values.atPose2(key_b), values.atVector(loss)
            ca, sa = math.cos(pose_a.theta()), math.sin(pose_a.theta())
            cb, sb = math.cos(pose_b.theta()), math.sin(pose_b.theta())
            east = pose_b.x() + cb * bx - sb * by - pose_a.x() - ca * ax + sa * ay
            north = pose_b.y() + sb * bx + cb * by - pose_a.y() - sa * ax - ca * ay
            squared = east * east + north * north + ANTENNA_M**2
            decades = 0.5 * math.log10(squared)
            if jacobians is not None:
                slope = -10.0 * law[1] / math.log(10.0) / squared
                # Along the axes of each pose; turning it moves its offset.
                xa, ya = -slope * (ca * east + sa * north), -slope * (ca * north - sa * east)
                xb, yb = slope * (cb * east + sb * north), slope * (cb * north - sb * east)
                jacobians[0] = np.array([[xa, ya, ax * ya - ay * xa]])
                jacobians[1] = np.array([[xb, yb, bx * yb - by * xb]])
                jacobians[2] = np.array([[1.0, -10.0 * decades]])
            return np.array([law[0] - 10.0 * law[1] * decades - dbm])

        return self.gtsam.CustomFactor(noise, [key_a, key_b, loss], error)

    def path_loss_prior(self) -> Any:
        """What is known of P0 and n beforehand."""
        noise = self.gtsam.noiseModel.Diagonal.Sigmas(np.array([P0_SIGMA_DB, EXPONENT_SIGMA]))
        return self.gtsam.PriorFactorVector(self.path_loss, self.path_loss_guess(), noise)

    def path_loss_guess(self) -> Any:
        """P0 (dBm) and n of the fixed law."""
        return np.array([P0_DBM, EXPONENT])

    def _diagonal(self, *sigmas: float) -> Any:
        return self.gtsam.noiseModel.Diagonal.Sigmas(np.array(sigmas))

    def _robust(self, noise: Any) -> Any:
        model = self.gtsam.noiseModel
        return model.Robust.Create(model.mEstimator.Cauchy.Create(CAUCHY), noise)
