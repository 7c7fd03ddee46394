"""How fast the tracker is, beside GTSAM and beside the clock on the wall."""
