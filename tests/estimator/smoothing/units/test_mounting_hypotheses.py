"""How units may be worn: what nobody has told that a unit faces, no turn on its boot explains."""

import math

import pytest
from msgspec.structs import replace

from estimator.fusion.entering.unit_mounting import RIGHT, Mounting
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.smoothing.units.mounting_hypotheses import TURNED_RARE, rather_faces
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of
from tests.estimator.trackers.test_unit_mounting import entry

MIRRORED = Mounting(True)
QUARTER, HALF, THREE_QUARTERS = (Mounting(False, 0.5 * k * math.pi) for k in (1, 2, 3))


def rather_faces_so(sigma_rad: float, way: Mounting) -> bool:
    """The same of a unit of which was told so surely what it faces."""
    readings: list[AnyReading] = [
        replace(r, heading_sigma_rad=sigma_rad) if isinstance(r, Node) and r.role == "responder" else r
        for r in entry(RIGHT, 0)[0]
        if r.t <= 10.0
    ]
    layout = solved_of(readings)[0].layout
    return rather_faces(layout.state, layout.walks[0].number, way)


@pytest.mark.parametrize("way", [QUARTER, HALF, THREE_QUARTERS])
def test_a_unit_of_which_nobody_told_what_it_faces_faces_elsewhere_rather_than_is_worn_turned(
    way: Mounting,
) -> None:
    assert rather_faces_so(3.0, way)
    assert not rather_faces_so(0.05, way)


def test_how_far_off_a_heading_may_be_is_held_against_how_rarely_a_unit_is_worn_wrongly() -> None:
    sigma_rad = 0.5 * math.pi / math.sqrt(-2.0 * TURNED_RARE)
    for way in (QUARTER, THREE_QUARTERS):
        assert rather_faces_so(1.01 * sigma_rad, way)
        assert not rather_faces_so(0.99 * sigma_rad, way)
    assert not rather_faces_so(1.01 * sigma_rad, HALF)


def test_no_heading_explains_a_mirrored_way() -> None:
    assert not rather_faces_so(3.0, MIRRORED)
