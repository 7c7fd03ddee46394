"""Two walk paper A's rectangle; on the second lap somebody kicks the third breadcrumb 4 m away."""

import numpy as np

from estimator.simulate.base import Scenario, in_posting_order
from estimator.simulate.breadcrumbs import kicked
from estimator.simulate.rectangle import END_S, sensed, walked
from estimator.simulate.team import reported

NAME = "kicked-breadcrumb"
KICKED, KICKED_S = "b3", 180.0


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    way = walked(rng)
    crumbs = [kicked(crumb, KICKED_S, rng) if crumb.node == KICKED else crumb for crumb in way.crumbs]
    reports = in_posting_order(reported(sensed(way.tracks, crumbs, {}, rng), "engine-7", rng))
    truth = way.tracks | {crumb.node: crumb.truth for crumb in crumbs}
    return Scenario(NAME, "A kicked breadcrumb", "recorded", (), reports, truth, END_S)
