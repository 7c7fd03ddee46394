"""A name that two radios answer to: ranges that disagree with a bearer's way agree with another one's.

Each range comes from the one or the other. The unit goes with one of them, and so does he who is
shown; what is left, if it were echoes, would agree with nobody.
"""

import numpy as np

from estimator.fusion.memory.state import FusionState
from estimator.graph.robust import mixture_cost
from estimator.smoothing.changes.recent_ranges import RecentRanges
from estimator.smoothing.changes.short_tracks import fit_freely

SPAN_S = 20.0
CLEAR, FAR_M = 12.0, 5.0
"""Log evidence from which on the others are a second radio's, and how far that is from the first one."""
AROUND, AWAY_M = 8, 15.0
"""It is looked for in so many directions, so far away."""
BOTH = 0.25
"""Share of the newest ranges that still agree with the bearer's way: his radio has not gone elsewhere."""
RADIOS = 3
"""To two that stand ranges fit in two places, and echoes often in one of them."""


def tell_duplicate_names(state: FusionState, hearing: RecentRanges) -> None:
    """Say which names two radios answer to.

    Args:
        state: the fusion: takes the notices.
        hearing: of a window.
    """
    if not hearing.enough:
        return
    layout, x = hearing.problem.layout, hearing.solved.x
    for i, walk in enumerate(layout.walks):
        node = state.life(walk.number)
        once = f"two radios of {node.node}"
        if walk.way is None or node.apart is not None or once in state.said or not hearing.disagree(i):
            continue
        heard = hearing.heard(i, hearing.until_t - SPAN_S, np.inf, strange=True, radios=RADIOS)
        if heard is None or hearing.agree(i, float(np.median(heard.t))) < BOTH:
            continue
        states = layout.states(x, i)
        shown_m = np.column_stack([np.interp(heard.t, layout.times[:, i], states[:, c]) for c in (0, 1)])
        turns = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
        away_m = AWAY_M * np.column_stack([np.cos(turns), np.sin(turns)])
        other = fit_freely(
            heard, [np.tile(shown_m.mean(axis=0) + off_m, (len(heard.t), 1)) for off_m in away_m]
        )
        ranged = heard.ranged
        off_m = shown_m - ranged.there_m
        residual = ranged.range_m - np.sqrt((off_m**2).sum(axis=1) + ranged.up_m**2)
        here = -float(mixture_cost(residual, ranged.sigma_m, *ranged.noise.T.copy()).sum())
        east, north = other.way_m[-1].tolist()
        if other.evidence - here > CLEAR and np.hypot(*(other.way_m - shown_m).T).min() > FAR_M:
            text = (
                f"two radios answer to the name {node.node}: one is with its unit, another one near "
                f"{east:.0f} m east, {north:.0f} m north; switch one off, or rename it"
            )
            state.say("conflict", state.newest_t, node.node, text, once=once)
