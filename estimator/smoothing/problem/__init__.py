"""The least-squares problem of a window, its prior from before, and its solution."""
