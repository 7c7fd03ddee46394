"""Images of the ground plane: where somebody may be whom readings tell only up to a turn or a reflection."""

import math
from collections.abc import Sequence
from typing import Self

import msgspec
import numpy as np

from estimator.graph.dense import Array

ALWAYS = math.inf
"""Since when somebody's way would be another one whose unit is worn another way: its beginning tells of it,
and no moment at which he may have changed sides."""
EVER = -math.inf
"""The same of a whole map of which nothing tells where north is."""


class Image(msgspec.Struct, frozen=True, array_like=True):
    """A turn or a reflection of the ground plane: (e, n) goes to the left by an angle, and is moved.

    Attributes:
        cosine: of the angle.
        sine: of the angle.
        flip: −1 where north and south are exchanged first; else 1.
        east_m: how far it is moved then.
        north_m: the same.
        turned_rad: by how much what a unit faces turns along; nil where it goes on as it is.
    """

    cosine: float = 1.0
    sine: float = 0.0
    flip: float = 1.0
    east_m: float = 0.0
    north_m: float = 0.0
    turned_rad: float = 0.0

    @property
    def matrix(self) -> Array:
        """Its linear part, 2 × 2."""
        return np.array([[self.cosine, -self.sine * self.flip], [self.sine, self.cosine * self.flip]])

    @property
    def shift_m(self) -> Array:
        """Its translation, 2 (m)."""
        return np.array([self.east_m, self.north_m])

    def of(self, places_m: Array) -> Array:
        """The images of places, … × 2 (m)."""
        return np.asarray(places_m @ self.matrix.T + self.shift_m)

    def move(self, states: Array) -> None:
        """Move states of a node without PDR (place and velocity, m × 6) to their images, in place."""
        states[:, :2] = self.of(states[:, :2])
        states[:, 3:5] = states[:, 3:5] @ self.matrix.T

    def back(self) -> "Image":
        """The inverse."""
        matrix = self.matrix.T
        east, north = (-matrix @ self.shift_m).tolist()
        sine = -self.sine if self.flip > 0 else self.sine
        return Image(self.cosine, sine, self.flip, east, north, -self.turned_rad)

    def after(self, first: Self) -> "Image":
        """Both as one: first `first`, then this."""
        matrix = self.matrix @ first.matrix
        east, north = self.of(first.shift_m).tolist()
        turned = self.turned_rad + first.turned_rad
        cosine, sine = float(matrix[0, 0]), float(matrix[1, 0])
        return Image(cosine, sine, self.flip * first.flip, east, north, turned)

    def through(self, here_m: Array, there_m: Array) -> "Image":
        """The same linear part, translated so that one place goes to another, 2 each (m)."""
        east, north = (there_m - self.matrix @ here_m).tolist()
        return Image(self.cosine, self.sine, self.flip, east, north, self.turned_rad)


class Alternative(msgspec.Struct, frozen=True, array_like=True):
    """Another place where somebody may be, with its probability.

    Attributes:
        of: number of the node whose way would be another one: his own, or somebody's who takes him along.
        share: how likely that is.
        image: where he would be now, as an image of his place.
        since_t: from when on that way would be another one (s), `ALWAYS` or `EVER`.
        way: the image of it.
    """

    of: int
    share: float
    image: Image
    since_t: float
    way: Image

    @property
    def by_unit(self) -> bool:
        """Whether it comes of how a unit may be worn, not of the side somebody went to."""
        return self.since_t == ALWAYS

    @property
    def mode(self) -> tuple[int, float, Image]:
        """Key of the solution that it is of, the same for everybody in that solution."""
        return self.of, self.since_t, self.way


def doubt_m2(others: Sequence[Alternative], place_m: Array) -> Array:
    """What it adds to the covariance of a place that somebody may be elsewhere, 3 × 3 (m²).

    The second moment about the place that is shown: an ellipse is to hold him wherever he is.

    Args:
        others: where he may be instead.
        place_m: where he is shown: east, north (m).
    """
    found = np.zeros((3, 3))
    for other in others:
        off_m = other.image.of(place_m) - place_m
        found[:2, :2] += other.share * np.outer(off_m, off_m)
    return found


def doubt_between_m2(a: Sequence[Alternative], a_m: Array, b: Sequence[Alternative], b_m: Array) -> Array:
    """The same of where one is relative to another: who would be elsewhere together is not apart, 3 × 3 (m²).

    Args:
        a: where the one may be instead.
        a_m: where he is shown: east, north (m).
        b: where the other may be instead.
        b_m: where he is shown (m).
    """
    found, off = np.zeros((3, 3)), dict[tuple[int, float, Image], tuple[float, Array]]()
    for sign, others, place_m in ((-1.0, a, a_m), (1.0, b, b_m)):
        for other in others:
            before = off.get(other.mode, (0.0, np.zeros(2)))[1]
            off[other.mode] = other.share, before + sign * (other.image.of(place_m) - place_m)
    for share, off_m in off.values():
        found[:2, :2] += share * np.outer(off_m, off_m)
    return found


def turned_about(centre_m: Array, by_rad: float) -> Image:
    """A turn to the left about a place."""
    return Image(float(np.cos(by_rad)), float(np.sin(by_rad))).through(centre_m, centre_m)


def mirrored(on_m: Array, towards_rad: float) -> Image:
    """A reflection in the line through a place towards a direction."""
    return Image(float(np.cos(2.0 * towards_rad)), float(np.sin(2.0 * towards_rad)), -1.0).through(on_m, on_m)
