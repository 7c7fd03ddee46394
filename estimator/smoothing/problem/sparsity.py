"""How the unknowns of a window hang together: where its readings, its priors and what it carries go."""

import numpy as np

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Indices
from estimator.graph.shared_errors import SharedErrors
from estimator.smoothing.chain.groups import GroupedReadings, Groups
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.problem.marginal_prior import MarginalPrior, SharedNumbers
from estimator.smoothing.readings.rows import Rows


class Sparsity:
    """Groups of walks, and what is added to the normal equations of each of them.

    Attributes:
        groups: those walks that hang together.
        rows: the readings among the groups.
        pairs: those of them that are pairs, of each group.
        shadows: which of each group lie in which shadow.
        priors: the walks' own priors among the groups.
        losses: what is known of losses, among the groups.
        shared: what each group has in common with the prior of the window.
    """

    def __init__(
        self, layout: Layout, rows: Rows, at: Indices, carried: MarginalPrior | None, lost: Indices
    ) -> None:
        """Find them.

        Args:
            layout: of the window.
            rows: its readings.
            at: flat columns of the walks' own priors.
            carried: the prior of the window; None: there is none.
            lost: columns of the border of losses and of those before them, n × 2; −1: none.
        """
        hang_together = [rows.columns] if carried is None else [rows.columns, carried.coupled]
        self.groups = groups = Groups(layout.width, layout.border, hang_together)
        self.rows: GroupedReadings = groups.placed(rows.slab, rows.columns)
        pairs = len(rows.pairs)
        self.pairs: list[Integers] = [part[: np.searchsorted(part, pairs)] for part in self.rows.parts]
        self.shadows: list[SharedErrors] = [rows.shadows.among(part) for part in self.rows.parts]
        size, width = layout.length * layout.width, max(layout.width, 1)
        slab = np.where(at < size, at // width, 0)
        columns = np.where(at < size, at % width, at - size + layout.width)
        self.priors: GroupedReadings = groups.placed(slab, columns[:, None])
        among = np.where(lost >= 0, layout.width + lost, -1)
        self.losses: GroupedReadings = groups.placed(np.zeros(len(lost), dtype=np.int64), among)
        self.shared: list[SharedNumbers] = [] if carried is None else carried.shared(groups.each)
