"""Drops: a breadcrumb lies where its bearer stands."""

import numpy as np

from estimator.fusion.entering import base_entry, introduce, reentry
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.recent_places import offset_of
from estimator.fusion.readings.between_reports import unsure_m2
from estimator.measurements.drop import Drop
from estimator.measurements.node import MOVING_ROLES


def hold(state: FusionState, reading: Drop) -> bool:
    """Let a breadcrumb lie where its bearer stands; False where that is not known, or it lies already."""
    by = state.node_of(reading.by, "responder", reading.t)
    waits = base_entry.waits_for_ranges(state, by, reading.t)
    if by.mode == "undecided" and by.role in MOVING_ROLES and not waits:
        base_entry.begin_at_base(state, by, reading.t)
        by = state.nodes[reading.by]
    unheard = by.absolute.beginning == "unheard"
    if not by.decided or by.apart is not None or unheard:
        text = f"nobody knows where {reading.by} is: {reading.node} cannot be dropped by it"
        state.say("conflict", reading.t, reading.node, text)
        state.count("not_fused")
        return False
    where = state.place(by)
    if by.moving:
        where = where + np.array(offset_of(state, by, reading.t))
    crumb = state.nodes.get(reading.node)
    if crumb is not None and crumb.mode == "retired" and crumb.role not in (*MOVING_ROLES, "base"):
        # It was picked up, and is dropped again.
        reentry.begin_anew(state, crumb, crumb.role, reading.t)
    unsure = unsure_m2(by, reading.t) if by.moving else np.zeros(3)
    done = introduce.drop(state, reading.node, by, where, reading.t, unsure)
    state.count("fused" if done else "not_fused")
    return done
