"""Who is moved without a step: crawls, lifts and stretchers, and those who only seem to be."""

import numpy as np
import pytest

from estimator.inertial.displacement import InertialDisplacement
from tests.estimator.inertial.boot_motion import BootMotion, Unit
from tests.estimator.inertial.boot_navigation import navigated, total_m, total_sigma_m, true_m
from tests.estimator.inertial.gait import Gait

UNITS = [Unit(1), Unit(2, scale=0.02), Unit(3, bias_mps2=0.2), Unit(4, bias_radps=0.05)]
CRAWLS = {
    "on the spot of a knee": (40, 0.5, 0.6, 0.6, 0.3),
    "fast": (40, 0.6, 0.4, 0.35, 0.4),
    "slowly": (25, 0.3, 1.5, 1.0, 0.15),
    "flat on the floor": (40, 0.4, 0.7, 0.5, 0.02),
}


def off_m(found: list[InertialDisplacement], gait: Gait) -> np.ndarray:
    """What the displacements lead past where it really is, 3 (m)."""
    true = true_m(gait, found[-1].t) - true_m(gait, found[0].from_t or 0.0)
    return np.asarray(total_m(found) - true)


def height_sigma_m(found: list[InertialDisplacement]) -> float:
    return float(np.sqrt(sum((d.sigma_m or 0.0) ** 2 + d.up_m2 for d in found)))


def begins() -> BootMotion:
    return BootMotion().rests(2.0).walks(4).kneels()


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("crawl", CRAWLS.values(), ids=CRAWLS)
def test_who_crawls_is_followed(crawl: tuple[int, float, float, float, float], unit: Unit) -> None:
    gait = begins().crawls(*crawl).kneels(-1.2).rests(2.0).gait()
    found, texts = navigated(unit.feels(gait).readings())
    assert texts == []
    way_m = crawl[0] * crawl[1]
    assert np.linalg.norm(off_m(found, gait)[:2]) < 0.1 * way_m
    assert total_sigma_m(found) < 0.3 * way_m


@pytest.mark.parametrize("unit", UNITS)
def test_who_crawls_without_a_rest_is_shown_as_unsure_as_he_is(unit: Unit) -> None:
    gait = begins().crawls(40, 0.5, 0.7, 0.12, 0.3).kneels(-1.2).rests(2.0).gait()
    found, _ = navigated(unit.feels(gait).readings())
    assert np.linalg.norm(off_m(found, gait)[:2]) < 2.0 * total_sigma_m(found)
    assert total_sigma_m(found) < 0.5 * 40 * 0.5


@pytest.mark.parametrize("unit", UNITS)
def test_who_kneels_and_shifts_stays_where_he_is(unit: Unit) -> None:
    gait = begins().fidgets(120.0).kneels(-1.2).rests(2.0).gait()
    found, texts = navigated(unit.feels(gait).readings())
    assert texts == []
    assert np.linalg.norm(off_m(found, gait)[:2]) < 0.5
    assert total_sigma_m(found) < 2.0


@pytest.mark.parametrize("unit", UNITS)
def test_who_works_on_the_spot_may_crawl_and_does_not(unit: Unit) -> None:
    gait = begins().works(30.0).kneels(-1.2).rests(2.0).gait()
    found, _ = navigated(unit.feels(gait).readings())
    assert np.linalg.norm(off_m(found, gait)[:2]) < 0.5
    assert 0.5 < total_sigma_m(found) < 10.0


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(("duration_s", "up_m"), [(8.0, 6.0), (8.0, -6.0), (20.0, 30.0)])
def test_who_stands_in_a_lift_may_be_on_another_storey(duration_s: float, up_m: float, unit: Unit) -> None:
    gait = BootMotion().rests(2.0).walks(4).rests(3.0).rides(duration_s, up_m).rests(3.0).gait()
    found, _ = navigated(unit.feels(gait).readings())
    up_off_m = off_m(found, gait)[2]
    assert abs(up_off_m) < 2.0 * height_sigma_m(found)
    assert np.linalg.norm(off_m(found, gait)[:2]) < 1.0


@pytest.mark.parametrize("unit", UNITS)
def test_who_is_carried_on_a_stretcher_is_not_shown_where_he_lay_down_for_certain(unit: Unit) -> None:
    gait = BootMotion().rests(2.0).walks(4).kneels(-1.2).rests(3.0).carried(30.0, 40.0).rests(3.0).gait()
    found, _ = navigated(unit.feels(gait).readings())
    assert np.linalg.norm(off_m(found, gait)) < 2.5 * total_sigma_m(found)


def test_a_blow_that_no_sample_saw_does_not_carry_who_stands_away() -> None:
    """His boot stands before and after it: what his accelerometers missed was no motion."""
    rests = BootMotion().rests(30.0).gait()
    force = rests.force.copy()
    force[1000:1010] += [60.0, 20.0, -30.0]
    found, texts = navigated(Unit(1).feels(rests._replace(force=force)).readings())
    assert texts == []
    assert np.linalg.norm(total_m(found)) < 1.0
    assert total_sigma_m(found) < 8.0


@pytest.mark.parametrize("bias_mps2", [0.1, 0.2])
def test_who_walks_and_turns_without_a_rest_is_no_less_sure_for_a_bad_accelerometer(bias_mps2: float) -> None:
    motion = BootMotion().rests(2.0)
    for _ in range(10):
        motion.walks(6).turns(0.8, 1.0)
    gait = motion.rests(2.0).gait()
    for seed in range(3):
        found, _ = navigated(Unit(seed, bias_mps2=bias_mps2).feels(gait).readings())
        assert total_sigma_m(found) < 1.5


@pytest.mark.parametrize("g_most", [8.0, 16.0])
@pytest.mark.parametrize("lasts_s", [0.01, 0.02])
def test_who_jumps_and_stands_is_on_his_storey(g_most: float, lasts_s: float) -> None:
    """The landing is more than the accelerometers can tell."""
    gait = BootMotion().rests(2.0).walks(2).rests(1.0).jumps(0.4, lasts_s).rests(40.0).gait()
    clipped = gait._replace(force=np.clip(gait.force, -9.8 * g_most, 9.8 * g_most))
    found, _ = navigated(Unit(1).feels(clipped).readings())
    assert abs(off_m(found, clipped)[2]) < 1.5
    assert height_sigma_m(found) < 4.0


def test_a_trolley_is_not_shown_where_it_was_loaded_for_certain() -> None:
    gait = BootMotion().rests(3.0).walks(2).rests(3.0).rides(30.0, 40.0, 1.5, upwards=False).rests(3.0).gait()
    found, _ = navigated(Unit(1).feels(gait).readings())
    assert np.linalg.norm(off_m(found, gait)) < 2.5 * total_sigma_m(found)
