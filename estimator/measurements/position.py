"""`position`: an absolute fix."""

from typing import Annotated

import numpy as np
from msgspec import Meta

from estimator.measurements.base import Identifier, LengthM, Reading, Sigma3M, Vector3M

LatitudeDeg = Annotated[float, Meta(ge=-90.0, le=90.0)]
LongitudeDeg = Annotated[float, Meta(ge=-180.0, le=180.0)]


class Position(Reading, tag="position", frozen=True):
    """Where a node is, by GNSS or by a fix at the door: local or WGS84, one of the two.

    Attributes:
        node: the node.
        position_m: east, north, up from the incident's origin (m).
        wgs84: latitude (°), longitude (°), height above the ellipsoid (m).
        sigma_m: standard deviations, east, north, up (m).
    """

    node: Identifier
    position_m: Vector3M | None = None
    wgs84: tuple[LatitudeDeg, LongitudeDeg, LengthM] | None = None
    sigma_m: Sigma3M | None = None

    def __post_init__(self) -> None:
        """Refuse a fix with no position or with two.

        Raises:
            ValueError: not exactly one of `position_m` and `wgs84` is given.
        """
        if (self.position_m is None) == (self.wgs84 is None):
            raise ValueError("give one of `position_m` and `wgs84`")


SEMI_MAJOR_M = 6_378_137.0
ECCENTRICITY_SQUARED = 6.694379990141e-3


def east_north_up(
    wgs84: tuple[float, float, float], origin: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Local position (m) of a WGS84 position in the tangent plane of the origin.

    Args:
        wgs84: latitude (°), longitude (°), height above the ellipsoid (m).
        origin: the same of the incident's origin.
    """
    latitude, longitude = np.radians(origin[0]), np.radians(origin[1])
    difference = _earth_centred(wgs84) - _earth_centred(origin)
    sin_lat, cos_lat, sin_lon, cos_lon = (
        np.sin(latitude),
        np.cos(latitude),
        np.sin(longitude),
        np.cos(longitude),
    )
    turn = np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    )
    east, north, up = (turn @ difference).tolist()
    return east, north, up


def _earth_centred(wgs84: tuple[float, float, float]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    latitude, longitude, height = np.radians(wgs84[0]), np.radians(wgs84[1]), wgs84[2]
    curvature = SEMI_MAJOR_M / np.sqrt(1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)
    return np.array(
        [
            (curvature + height) * np.cos(latitude) * np.cos(longitude),
            (curvature + height) * np.cos(latitude) * np.sin(longitude),
            (curvature * (1.0 - ECCENTRICITY_SQUARED) + height) * np.sin(latitude),
        ]
    )
