"""What a boot's first half second tells of what it faces."""

import numpy as np
import pytest

from estimator.inertial.boot import GRAVITY_MPS2
from estimator.inertial.levelling import ANYWHERE_RAD, azimuth_variance_rad2
from estimator.inertial.navigation import navigate
from estimator.inertial.progress import Navigation
from estimator.inertial.rotations import level
from estimator.inertial.samples import pieces
from estimator.measurements.imu import Imu

TILT_RAD = 0.02


@pytest.mark.parametrize("elevation_deg", [0.0, 30.0, 60.0, 80.0, -70.0])
def test_a_tilt_that_is_not_known_veers_an_axis_by_its_elevations_tangent(elevation_deg: float) -> None:
    """Held against how far the frames of a thousand boots are turned that were levelled so."""
    chance = np.random.default_rng(1)
    elevation = np.radians(elevation_deg)
    up = np.array([np.sin(elevation), 0.0, np.cos(elevation)])
    attitude, faced = level(up, 0, 0.0), []
    for tilt in chance.normal(0.0, TILT_RAD, (1000, 3)):
        turned = attitude @ level(up + np.cross(tilt, up), 0, 0.0).T
        faced.append(np.arctan2(turned[1, 0] - turned[0, 1], turned[0, 0] + turned[1, 1]))
    expected = TILT_RAD * abs(np.tan(elevation))
    assert np.std(faced) == pytest.approx(expected, rel=0.15, abs=1e-3)
    assert azimuth_variance_rad2(float(np.sin(elevation)), TILT_RAD) == pytest.approx(expected**2)


def test_an_axis_that_points_up_may_face_anything() -> None:
    assert azimuth_variance_rad2(1.0, TILT_RAD) == ANYWHERE_RAD**2


@pytest.mark.parametrize(("elevation_deg", "unsure_rad", "said"), [(0.0, 0.0, False), (88.0, 0.57, True)])
def test_who_wears_it_steeply_is_as_unsure_of_what_he_faces(
    elevation_deg: float, unsure_rad: float, said: bool
) -> None:
    elevation, chance = np.radians(elevation_deg), np.random.default_rng(2)
    up = GRAVITY_MPS2 * np.array([np.sin(elevation), 0.0, np.cos(elevation)])
    force, rate = chance.normal(up, 0.02, (100, 3)), chance.normal(0.0, 0.002, (100, 3))
    rest = Imu(t=0.0, node="ff1", rate_hz=100.0, accel_mps2=triples(force), gyro_radps=triples(rate))
    known: Navigation | None = None
    turned_rad2, texts = 0.0, []
    for piece in pieces(rest):
        done = navigate(known, piece, 0.0)
        known = done.navigation
        turned_rad2 += sum(led.turned_rad2 for led in done.displacements)
        texts += [done.text] if done.text is not None else []
    assert np.sqrt(turned_rad2) == pytest.approx(unsure_rad, rel=0.1, abs=5e-3)
    assert bool(texts) == said


def triples(rows: np.ndarray) -> list[tuple[float, float, float]]:
    return [(float(x), float(y), float(z)) for x, y, z in rows]
