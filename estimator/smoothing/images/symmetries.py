"""Images of the ground plane that leave ranges to one radio, or to two, as they are."""

import numpy as np

from estimator.fusion.images import Image, mirrored, turned_about
from estimator.graph.dense import Array

TURNS = 8


def around(radio_m: Array, towards_rad: float) -> list[Image]:
    """Turns and reflections that leave all ranges to one radio as they are."""
    turns = [turned_about(radio_m, 2.0 * np.pi * j / TURNS) for j in range(1, TURNS)]
    return turns + [mirrored(radio_m, towards_rad + np.pi * j / TURNS) for j in range(TURNS)]


def across(radios: list[Array], places_m: Array) -> list[tuple[Image, Array]]:
    """The reflection that leaves ranges to two radios as they are, and how far off its line places are."""
    if len(radios) < 2:
        return []
    # The same line is the same image, whichever of them tells more.
    one, other = sorted(radios, key=lambda place_m: tuple(place_m.tolist()))
    towards = float(np.arctan2(other[1] - one[1], other[0] - one[0]))
    off = places_m - one
    return [(mirrored(one, towards), np.cos(towards) * off[:, 1] - np.sin(towards) * off[:, 0])]
