"""How each kind of reading is taken in: samples, displacements, fixes and heights, those between nodes."""
