"""The unknowns: who moves and stands at which keyframe, how each goes, and what is known beforehand."""
