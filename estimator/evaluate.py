"""Estimates against truth: errors, and whether the covariances are honest."""

from typing import NamedTuple

import numpy as np

from estimator.graph.dense import Array

ELLIPSE_95 = 5.991464547107979
"""95th percentile of χ² with two degrees of freedom: 2.448 standard deviations."""
ELLIPSE_999, ELSEWHERE_M = 13.815510557964274, 2.0
"""Outside the 99.9 % ellipse, and farther than so from where he is shown, somebody is surely elsewhere."""


class Errors(NamedTuple):
    """How far one track is from the truth.

    Attributes:
        rmse_m: root mean square of the horizontal errors (m).
        mean_m: their mean (m).
        max_m: the largest (m).
        ce95_m: 95 % of horizontal errors are smaller (m): CE95 of ISO/IEC 18305.
        ve95_m: 95 % of vertical errors are smaller (m).
        aligned_rmse_m: as `rmse_m`, after the rigid motion that fits best.
        mean_percent: `mean_m` in percent of the way walked.
        max_percent: `max_m` in percent of the way walked.
        coverage: share of true positions inside the 95 % ellipse.
        nees: mean normalised squared error per degree of freedom, horizontal; 1 is honest.
        misleading: share of epochs at which the truth is surely elsewhere: see `ELSEWHERE_M`.
    """

    rmse_m: float
    mean_m: float
    max_m: float
    ce95_m: float
    ve95_m: float
    aligned_rmse_m: float
    mean_percent: float
    max_percent: float
    coverage: float
    nees: float
    misleading: float


def rigid_fit(source: Array, target: Array) -> tuple[Array, Array]:
    """Rotation and translation, without scale, that bring `source` nearest to `target` (Umeyama 1991).

    Args:
        source: m × d.
        target: m × d.

    Returns:
        Rotation d × d and translation d: `source @ rotation.T + translation`.
    """
    from_mean, to_mean = source.mean(axis=0), target.mean(axis=0)
    u, _, v = np.linalg.svd((target - to_mean).T @ (source - from_mean))
    mirror = np.eye(source.shape[1])
    mirror[-1, -1] = np.sign(np.linalg.det(u) * np.linalg.det(v))
    rotation = u @ mirror @ v
    return rotation, to_mean - rotation @ from_mean


def errors(estimated: Array, truth: Array, covariance: Array | None, distance_m: float) -> Errors:
    """Compare a track with the truth at the same epochs.

    Args:
        estimated: east, north, up, m × 3 (m).
        truth: the same.
        covariance: m × 3 × 3 (m²); None: not judged.
        distance_m: the way walked (m).

    Raises:
        ValueError: the arrays differ in length, or there is no epoch.
    """
    if len(estimated) == 0 or estimated.shape != truth.shape:
        raise ValueError(f"cannot compare {estimated.shape} estimates with {truth.shape} true positions")
    off = estimated - truth
    horizontal = np.hypot(off[:, 0], off[:, 1])
    rotation, translation = rigid_fit(estimated[:, :2], truth[:, :2])
    aligned = estimated[:, :2] @ rotation.T + translation - truth[:, :2]
    coverage = nees = misleading = float("nan")
    if covariance is not None:
        solved = np.linalg.solve(covariance[:, :2, :2], off[:, :2, None])[:, :, 0]
        squared = np.einsum("mi,mi->m", off[:, :2], solved)
        coverage, nees = float((squared <= ELLIPSE_95).mean()), float(squared.mean() / 2.0)
        misleading = float(((squared > ELLIPSE_999) & (horizontal > ELSEWHERE_M)).mean())
    mean, largest = float(horizontal.mean()), float(horizontal.max())
    return Errors(
        rmse_m=float(np.sqrt((horizontal**2).mean())),
        mean_m=mean,
        max_m=largest,
        ce95_m=float(np.quantile(horizontal, 0.95)),
        ve95_m=float(np.quantile(np.abs(off[:, 2]), 0.95)),
        aligned_rmse_m=float(np.sqrt((aligned**2).sum(axis=1).mean())),
        mean_percent=100.0 * mean / distance_m,
        max_percent=100.0 * largest / distance_m,
        coverage=coverage,
        nees=nees,
        misleading=misleading,
    )


def full_covariance(upper: Array) -> Array:
    """Upper triangles ee, en, eu, nn, nu, uu, m × 6, as matrices, m × 3 × 3."""
    matrices: Array = upper[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
    return matrices
