"""What the default tracker fuses, and how: nodes, motion, readings between nodes, beginnings, update."""
