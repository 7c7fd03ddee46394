"""How each moves from tick to tick: along its unit's way, with a velocity, in silence."""
