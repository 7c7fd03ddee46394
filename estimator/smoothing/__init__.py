"""The whole incident solved again: keyframes of all that moves in one chain, what stands beside it."""
