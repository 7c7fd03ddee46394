"""What a solution is the less sure by where the log may begin when people were inside already."""

import numpy as np

from estimator.fusion.entering.late_start import unsure_m2
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Layout


def doubt_starts(layout: Layout, found: tuple[Array, Array, Array]) -> None:
    """Let covariances hold that those who are taken to have entered at the base may not have.

    Each is elsewhere by the same all the time: who is shown near the base when the log begins may be
    elsewhere, and so has all been where his way has led him since.

    Args:
        layout: of the whole incident.
        found: covariances of the keyframes, of each with the next one and of the border, as
            `Chain.covariances` gives them; changed in place.
    """
    state = layout.state
    unsure = unsure_m2(state)
    # Where a way was ended for readings to tell where it goes on, what led there is as unsure as it was.
    ended = {
        number: life.absolute.late.doubt_m2
        for number, life in state.ended.items()
        if life.absolute.beginning == "assumed"
    }
    most_m2 = max(ended.values(), default=0.0)
    if not unsure and most_m2 == 0.0:
        return
    keyframes, ahead, border = found
    for i, walk in enumerate(layout.walks):
        name = walk.node.node
        own = unsure.get(name, 0.0) if walk.number == state.nodes[name].index else ended.get(walk.number, 0.0)
        keyframes[:, i, :2, :2] += own * np.eye(2)
        ahead[:, i, :2, :2] += own * np.eye(2)
    for number, start in layout.stands.items():
        node = state.nodes[state.owners[number]]
        own = unsure.get(node.node, 0.0) if node.decided else most_m2
        border[start : start + 2, start : start + 2] += own * np.eye(2)


def doubt_now(layout: Layout, name: str) -> Array:
    """What is added to the covariance of a node's place now, 3 × 3 (m²)."""
    found = np.zeros((3, 3))
    found[[0, 1], [0, 1]] = unsure_m2(layout.state).get(name, 0.0)
    return found
