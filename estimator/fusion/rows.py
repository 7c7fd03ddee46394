"""Readings of one tick as arrays: what each is held against, and its linearisation at any estimate."""

from collections.abc import Callable, Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from estimator.estimate import Vector3
from estimator.graph.dense import Array, Indices
from estimator.graph.robust import Mixture
from estimator.graph.variable import Variable
from estimator.measurements.bearing import predict_bearing, wrap
from estimator.measurements.range import PairJacobian, predict_range
from estimator.measurements.rssi import predict_rssi

PairKind = Literal["range", "rssi", "bearing"]


class Linear(NamedTuple):
    """A reading of one number of one block: an axis of a position, a bias.

    Attributes:
        variable: the block.
        axis: which of its numbers.
        value: what was read.
        sigma: its standard deviation.
        noise: its outliers.
        source: the technology or kind that it is counted under.
    """

    variable: Variable
    axis: int
    value: float
    sigma: float
    noise: Mixture
    source: str = ""


class End(NamedTuple):
    """One end of a reading between two nodes.

    Attributes:
        variable: the block of its position; None: it is fixed, at `offset_m`.
        offset_m: where it stood at the reading's epoch, from that block (m).
    """

    variable: Variable | None
    offset_m: Vector3


class Pair(NamedTuple):
    """A reading between two nodes.

    Attributes:
        kind: what was read.
        a: the end that measured.
        b: the other one.
        extra: the block of the technology's states, or of the unit that a bearing is counted from.
        value: what was read.
        sigma: its standard deviation.
        noise: its outliers.
        source: the technology that its noise is learned for.
        nominal: its claimed or assumed standard deviation.
        link: key of the link that it belongs to; "" where it is not followed.
        constant: what is added to the extra block's first number: reported heading (rad), sent power (dBm).
    """

    kind: PairKind
    a: End
    b: End
    extra: Variable | None
    value: float
    sigma: float
    noise: Mixture
    source: str
    nominal: float
    link: str = ""
    constant: float = 0.0


class Rows(NamedTuple):
    """m readings, linearised: columns and derivatives m × k, and residuals m."""

    columns: Indices
    jacobian: Array
    residual: Array


class Stack:
    """All readings of a tick, resolved to the rows where blocks start; valid until a block is deleted.

    Attributes:
        value: what the linear readings read, in front of the others.
        sigma: standard deviations, m.
        outliers: see `Mixture`, m.
        shift: see `Mixture`, m.
        spread: see `Mixture`, m.
        sources: technology of each, m.
        nominal: claimed or assumed standard deviation of each, m.
        links: link of each, m.
    """

    def __init__(
        self, starts: Mapping[Variable, int], linear: Sequence[Linear], pairs: Sequence[Pair]
    ) -> None:
        by_kind = [[p for p in pairs if p.kind == kind] for kind in ("range", "rssi", "bearing")]
        everything: list[Linear | Pair] = [*linear, *(p for group in by_kind for p in group)]
        self.sigma: Array = np.array([r.sigma for r in everything])
        noise = np.array([r.noise for r in everything]).reshape(len(everything), 3)
        self.outliers, self.shift, self.spread = noise.T
        self.sources = [r.source for r in everything]
        self.nominal = [r.nominal if isinstance(r, Pair) else r.sigma for r in everything]
        self.links = [r.link if isinstance(r, Pair) else "" for r in everything]
        self.value: Array = np.array([r.value for r in linear])
        self._columns = np.array([starts[r.variable] + r.axis for r in linear], dtype=np.intp)
        self.groups = [Group(starts, group) for group in by_kind if group]

    def __len__(self) -> int:
        return len(self.sources)

    def linearise(self, x: Array) -> Rows:
        """Residuals and Jacobians at an estimate x, n."""
        columns = np.zeros((len(self), 8), dtype=np.intp)
        jacobian = np.zeros((len(self), 8))
        residual = np.zeros(len(self))
        end = len(self.value)
        columns[:end, 0], jacobian[:end, 0] = self._columns, 1.0
        residual[:end] = self.value - x[self._columns]
        for group in self.groups:
            start, end = end, end + len(group.value)
            columns[start:end] = group.columns
            group.linearise(x, jacobian[start:end], residual[start:end])
        return Rows(columns, jacobian, residual)


class Group:
    """The pair readings of one kind.

    Attributes:
        value: what was read, m.
        offset_a: where the end that measured stood from its block, m × 3 (m).
        offset_b: the same of the other end.
        columns: rows of the blocks that each depends on, m × 8; 0 where there is none.
    """

    def __init__(self, starts: Mapping[Variable, int], pairs: Sequence[Pair]) -> None:
        self.predict = PREDICT[pairs[0].kind]
        self.turns = pairs[0].kind == "bearing"
        self.value: Array = np.array([p.value for p in pairs])
        self._constant = np.array([p.constant for p in pairs])
        self.offset_a = np.array([p.a.offset_m for p in pairs])
        self.offset_b = np.array([p.b.offset_m for p in pairs])
        blocks = [(p.a.variable, p.b.variable, p.extra) for p in pairs]
        rows = [[-1 if v is None else starts[v] for v in three] for three in blocks]
        a, b, extra = np.array(rows, dtype=np.intp).T
        spans = (a[:, None] + np.arange(3), b[:, None] + np.arange(3), extra[:, None] + np.arange(2))
        self._used: Array = np.repeat(np.array([a, b, extra]).T >= 0, (3, 3, 2), axis=1).astype(np.float64)
        self.columns: Indices = np.where(self._used > 0.0, np.concatenate(spans, axis=1), 0)

    def linearise(self, x: Array, jacobian: Array, residual: Array) -> None:
        """Fill Jacobian (m × 8) and residual (m) at an estimate x, n."""
        there = x[self.columns] * self._used
        extra_1, extra_2 = there[:, 6] + self._constant, there[:, 7]
        got = self.predict(there[:, :3] + self.offset_a, there[:, 3:6] + self.offset_b, extra_1, extra_2)
        difference = self.value - got.predicted
        residual[:] = wrap(difference) if self.turns else difference
        jacobian[:] = np.concatenate([got.by_a, got.by_b, got.by_extra], axis=1) * self._used


def _bearing(a: Array, b: Array, heading_rad: Array, _: Array) -> PairJacobian:
    return predict_bearing(a, b, heading_rad)


PREDICT: dict[PairKind, Callable[[Array, Array, Array, Array], PairJacobian]] = {
    "range": predict_range,
    "rssi": predict_rssi,
    "bearing": _bearing,
}
