"""The readings of a window as rows: where their ends stand, what they say there, how noisy they are."""
