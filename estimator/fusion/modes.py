"""All places from which a set of ranges or powers may come: one robust solve from many starts at once."""

from typing import Literal, NamedTuple

import numpy as np

from estimator.graph.dense import Array
from estimator.measurements.range import predict_range
from estimator.measurements.rssi import predict_rssi

ANGLES = 12
STEPS = 25
CAUCHY = 2.0
APART_M = 2.0
USED_MAX = 120


class Sought(NamedTuple):
    """What is known of an undecided node.

    Attributes:
        kind: what was measured.
        points: where from, m × 3 (m).
        value: ranges (m) or powers (dBm), m.
        sigma: standard deviations, m.
        up_m: mean of the prior of its height (m).
        up_sigma_m: standard deviation of that prior (m).
        extra: states of the technology, 2.
        extra_covariance: of `extra`, 2 × 2.
    """

    kind: Literal["range", "rssi"]
    points: Array
    value: Array
    sigma: Array
    up_m: float
    up_sigma_m: float
    extra: Array
    extra_covariance: Array


class Mode(NamedTuple):
    """A place that fits.

    Attributes:
        position_m: east, north, up, 3 (m).
        cost: negative log likelihood, up to a constant.
        sigma_m: standard deviation along the worst horizontal direction (m).
        up_sigma_m: standard deviation of the height (m).
    """

    position_m: Array
    cost: float
    sigma_m: float
    up_sigma_m: float


def find_modes(sought: Sought) -> list[Mode]:
    """Places that fit, best first, each apart from the better ones (`APART_M`, or three sigma).

    Levenberg-Marquardt with the Cauchy loss from rings around the first, middle and last place, all starts in
    one batch; the technology's states are solved along, so that an unknown scale does not spoil the fit.
    """
    sought = _thinned(sought)
    state = _starts(sought)
    normal, gradient, cost = _linearise(sought, state)
    damping = np.full(len(state), 1e-3)
    diagonal = np.arange(5)
    for _ in range(STEPS):
        damped = normal.copy()
        damped[:, diagonal, diagonal] *= 1.0 + damping[:, None]
        there = state + np.linalg.solve(damped, gradient[:, :, None])[:, :, 0]
        normal_there, gradient_there, cost_there = _linearise(sought, there)
        better = cost_there < cost
        state = np.where(better[:, None], there, state)
        normal = np.where(better[:, None, None], normal_there, normal)
        gradient = np.where(better[:, None], gradient_there, gradient)
        cost = np.where(better, cost_there, cost)
        damping = np.clip(np.where(better, damping * 0.3, damping * 8.0), 1e-9, 1e9)
    modes: list[Mode] = []
    for i in np.argsort(cost, kind="stable"):
        covariance = np.linalg.inv(normal[i])[:3, :3]
        spread = float(np.sqrt(np.linalg.eigvalsh(covariance[:2, :2])[-1]))
        mode = Mode(state[i, :3].copy(), float(cost[i]), spread, float(np.sqrt(covariance[2, 2])))
        apart = [float(np.hypot(*(mode.position_m - m.position_m)[:2])) for m in modes]
        if all(d > max(APART_M, 3.0 * m.sigma_m) for d, m in zip(apart, modes, strict=True)):
            modes.append(mode)
    return modes


def _thinned(sought: Sought) -> Sought:
    m = len(sought.value)
    if m <= USED_MAX:
        return sought
    kept = np.linspace(0, m - 1, USED_MAX).astype(np.intp)
    return sought._replace(points=sought.points[kept], value=sought.value[kept], sigma=sought.sigma[kept])


def _starts(sought: Sought) -> Array:
    m = len(sought.value)
    if sought.kind == "range":
        distance = sought.value
    else:
        decades = (sought.extra[0] - sought.value) / (10.0 * max(sought.extra[1], 1.0))
        distance = 10.0 ** np.clip(decades, -1.0, 2.5)
    angles = np.arange(ANGLES) * (2.0 * np.pi / ANGLES)
    around = np.column_stack([np.cos(angles), np.sin(angles)])
    centres = sorted({0, m // 2, m - 1, int(np.argmin(distance))})
    rings = [sought.points[i, :2] + around * max(distance[i], 0.5) for i in centres]
    horizontal = np.concatenate(rings)
    rest = np.broadcast_to([sought.up_m, *sought.extra], (len(horizontal), 3))
    return np.column_stack([horizontal, rest])


def _linearise(sought: Sought, state: Array) -> tuple[Array, Array, Array]:
    """Normal matrices s × 5 × 5, gradients s × 5 and costs s at states s × 5."""
    s, m = len(state), len(sought.value)
    here = np.repeat(state[:, :3], m, axis=0)
    points = np.tile(sought.points, (s, 1))
    predict = predict_range if sought.kind == "range" else predict_rssi
    got = predict(points, here, np.repeat(state[:, 3], m), np.repeat(state[:, 4], m))
    jacobian = np.concatenate([got.by_b, got.by_extra], axis=1).reshape(s, m, 5) / sought.sigma[:, None]
    residual = (sought.value - got.predicted.reshape(s, m)) / sought.sigma
    weight = 1.0 / (1.0 + (residual / CAUCHY) ** 2)
    prior = np.zeros((5, 5))
    prior[0, 0] = prior[1, 1] = 1e-8
    prior[2, 2] = sought.up_sigma_m**-2
    prior[3:, 3:] = np.linalg.inv(sought.extra_covariance)
    mean = np.array([0.0, 0.0, sought.up_m, *sought.extra])
    off = mean - state
    off[:, :2] = 0.0
    weighted = jacobian * weight[:, :, None]
    normal = np.matmul(weighted.transpose(0, 2, 1), jacobian) + prior
    gradient = np.matmul(weighted.transpose(0, 2, 1), residual[:, :, None])[:, :, 0] + off @ prior
    cost = 0.5 * CAUCHY**2 * np.log1p((residual / CAUCHY) ** 2).sum(axis=1)
    return normal, gradient, cost + 0.5 * np.einsum("si,ij,sj->s", off, prior, off)
