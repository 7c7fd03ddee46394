"""Small line drawings as inline SVG: equal axes for maps, time against metres for errors."""

import math
from collections.abc import Sequence
from html import escape
from typing import NamedTuple

import numpy as np

from estimator.simulate.base import FloatArray

MOST_POINTS = 500
MARGIN = 34.0


class Line(NamedTuple):
    """One line of a plot.

    Attributes:
        points: n × 2, in the plot's own units.
        css: its class.
        label: what a pointer over it says.
    """

    points: FloatArray
    css: str
    label: str


def plot(lines: Sequence[Line], width: float, height: float, *, equal: bool, units: tuple[str, str]) -> str:
    """A plot of some lines, with a grid at round numbers.

    Args:
        lines: at least one; those without points are left out.
        width: of the drawing (px).
        height: of the drawing (px).
        equal: a metre is as long to the right as upwards; else zero is the lowest value upwards.
        units: what is written along each axis.
    """
    drawn = [line._replace(points=_thinned(line.points)) for line in lines if len(line.points)]
    if not drawn:
        return ""
    everything = np.concatenate([line.points for line in drawn])
    low, high = everything.min(axis=0), everything.max(axis=0)
    if not equal:
        low[1] = 0.0
    span = np.maximum(high - low, 1e-3)
    scale = np.array([width - 2 * MARGIN, height - 2 * MARGIN]) / span
    if equal:
        scale[:] = scale.min()
    shift = np.array([MARGIN, height - MARGIN])
    flip = np.array([1.0, -1.0])

    def place(points: FloatArray) -> FloatArray:
        placed: FloatArray = shift + flip * (points - low) * scale
        return placed

    parts = [f'<svg viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}">']
    for axis in (0, 1):
        for value in _ticks(float(low[axis]), float(high[axis])):
            at = low.copy()
            at[axis] = value
            x, y = place(at).tolist()
            if axis == 0:
                parts.append(f'<path class="grid" d="M{x:.1f} {MARGIN}V{height - MARGIN}"/>')
                parts.append(
                    f'<text x="{x:.1f}" y="{height - MARGIN + 14}" text-anchor="middle">{value:g}</text>'
                )
            else:
                parts.append(f'<path class="grid" d="M{MARGIN} {y:.1f}H{width - MARGIN}"/>')
                parts.append(f'<text x="{MARGIN - 4}" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>')
    parts.append(f'<text x="{width - MARGIN}" y="{height - 4}" text-anchor="end">{escape(units[0])}</text>')
    parts.append(f'<text x="4" y="12">{escape(units[1])}</text>')
    for line in drawn:
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in place(line.points).tolist())
        title = f"<title>{escape(line.label)}</title>"
        parts.append(f'<polyline class="{escape(line.css)}" points="{path}">{title}</polyline>')
    return "".join([*parts, "</svg>"])


def _thinned(points: FloatArray) -> FloatArray:
    every = max(1, math.ceil(len(points) / MOST_POINTS))
    return points[::every]


def _ticks(low: float, high: float) -> list[float]:
    """About five round numbers between two."""
    rough = max(high - low, 1e-9) / 5.0
    power = 10.0 ** math.floor(math.log10(rough))
    step = power * min((1.0, 2.0, 5.0, 10.0), key=lambda one: abs(one - rough / power))
    first, last = math.ceil(low / step), math.floor(high / step)
    return [round(k * step, 6) for k in range(first, last + 1)]
