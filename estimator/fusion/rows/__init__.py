"""The readings of a tick as rows of numbers, and the solution of them all."""
