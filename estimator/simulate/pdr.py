"""A pedestrian dead-reckoning unit: displacements in a frame that its gyro turns away from east."""

from dataclasses import dataclass

import numpy as np

from estimator.measurements import Displacement
from estimator.simulate.base import FloatArray, TrueTrack

REST_M = 0.02
"""Below this displacement in one period the foot stands still, and the zero-velocity update holds."""
CRAWLS_MPS = 0.6
"""Who goes more slowly crawls."""


@dataclass(frozen=True, slots=True)
class PdrUnit:
    """How good a unit is.

    Attributes:
        period_s: it reports this often (s).
        heading_sigma_rad: error of its alignment to east at the start (rad).
        bias_radps: what its gyro turns the frame by, each second (rad/s).
        heading_walk_rad: random walk of the heading error, each period in which the foot steps (rad).
        scale: it reports the true displacement divided by this.
        rises: its heights rise by so much for each metre of level way (m/m).
        crawls: it tells this share of what its bearer crawls.
        noise_m: standard deviation per axis and report while moving (m).
        rest_noise_m: the same while the foot stands (m).
        heading_noise_rad: standard deviation of the reported heading (rad).
    """

    period_s: float = 1.0
    heading_sigma_rad: float = 0.1
    bias_radps: float = 0.0
    heading_walk_rad: float = 0.004
    scale: float = 1.0
    rises: float = 0.0
    crawls: float = 1.0
    noise_m: float = 0.03
    rest_noise_m: float = 0.002
    heading_noise_rad: float = 0.01


@dataclass(frozen=True, slots=True)
class DeadReckoning:
    """What a unit reckoned: kept whole, so that reports may be merged over a radio gap.

    Attributes:
        t_s: ends of the periods, n (s); the first period begins at `start_s`.
        delta_m: displacement of each period in the unit's frame, n × 3 (m).
        heading_rad: heading in that frame at each end, n (rad).
        start_s: beginning of the first period (s).
    """

    t_s: FloatArray
    delta_m: FloatArray
    heading_rad: FloatArray
    start_s: float


def reckon(truth: TrueTrack, unit: PdrUnit, rng: np.random.Generator) -> DeadReckoning:
    """What `unit` on a walker with `truth` reports.

    The frame's error ψ starts at a draw of `heading_sigma_rad` and drifts by bias and random walk;
    with p' = p + s·Rz(ψ)·δ the report is δ = Rz(-ψ)·Δp / s + noise; its heights rise with the way, and of a
    crawl it tells a share.

    Args:
        truth: the walker's true track.
        unit: how good the unit is.
        rng: where the errors come from.
    """
    ends = np.arange(truth.t_s[0] + unit.period_s, truth.t_s[-1] + 1e-6, unit.period_s)
    n = len(ends)
    true = np.diff(truth.at(np.concatenate([truth.t_s[:1], ends])), axis=0)
    stepped = np.linalg.norm(true, axis=1) > REST_M
    psi = rng.normal(0.0, unit.heading_sigma_rad) + np.cumsum(
        unit.bias_radps * unit.period_s + rng.normal(0.0, unit.heading_walk_rad, n) * stepped
    )
    delta = np.stack(
        [
            np.cos(psi) * true[:, 0] + np.sin(psi) * true[:, 1],
            -np.sin(psi) * true[:, 0] + np.cos(psi) * true[:, 1],
            true[:, 2] + unit.rises * np.hypot(true[:, 0], true[:, 1]),
        ],
        axis=1,
    )
    crawls = np.linalg.norm(true, axis=1) < CRAWLS_MPS * unit.period_s
    delta[:, :2] *= np.where(crawls, unit.crawls, 1.0)[:, None]
    sigma = np.where(np.linalg.norm(true, axis=1) < REST_M, unit.rest_noise_m, unit.noise_m)
    delta = delta / unit.scale + rng.normal(0.0, 1.0, (n, 3)) * sigma[:, None]
    heading = truth.heading_at(ends) - psi + rng.normal(0.0, unit.heading_noise_rad, n)
    return DeadReckoning(ends, delta, heading, float(truth.t_s[0]))


def displacements(
    node: str, reckoned: DeadReckoning, silent: tuple[float, float] = (np.inf, np.inf)
) -> list[Displacement]:
    """The readings of a unit.

    Args:
        node: the unit.
        reckoned: see `reckon`.
        silent: from when to when (s) its radio is dead; what it walked then comes as one displacement
            with `from_t` when the radio is back.
    """
    readings = []
    since = reckoned.start_s
    pending = np.zeros(3)
    for t, delta, heading in zip(
        reckoned.t_s.tolist(), reckoned.delta_m, reckoned.heading_rad.tolist(), strict=True
    ):
        pending = pending + delta
        if silent[0] <= t < silent[1]:
            continue
        readings.append(
            Displacement(
                t=round(t, 3),
                node=node,
                delta_m=(
                    round(float(pending[0]), 4),
                    round(float(pending[1]), 4),
                    round(float(pending[2]), 4),
                ),
                from_t=round(since, 3),
                heading_rad=round(heading, 4),
            )
        )
        since, pending = t, np.zeros(3)
    return readings
