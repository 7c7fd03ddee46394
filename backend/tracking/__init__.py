"""The estimator worker, and what is asked of its results: frames, tracks, relative positions."""
