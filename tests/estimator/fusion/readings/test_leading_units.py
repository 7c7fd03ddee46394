"""Which displacements lead their bearers."""

from msgspec.structs import replace

from estimator.fusion.memory.separated_unit import SeparatedUnit
from estimator.fusion.readings.leading_units import leading
from tests.estimator.fusion.entering.test_carried_bearer import carried, tells
from tests.estimator.smoothing.windows import entered, fused


def test_a_standstill_moves_nobody_and_the_first_step_does() -> None:
    state = carried()
    assert leading(state, [tells(16, 0.02, 15.0)]) == []
    assert state.nodes["ff1"].carried_t == 16.0
    step = tells(17, 0.6, 16.0)
    assert leading(state, [step]) == [step]
    assert state.nodes["ff1"].carried_t is None


def test_a_jolt_of_a_boot_is_no_step_of_its_bearer() -> None:
    state = carried()
    assert leading(state, [tells(16, 0.3, 15.0), tells(17, -0.2, 16.0), tells(18, 0.01, 17.0)]) == []
    assert leading(state, [tells(19, 0.3, 18.0)]) == []
    assert len(leading(state, [tells(20, 0.3, 19.0)])) == 1


def test_a_step_that_does_not_say_since_when_begins_where_the_standstill_ended() -> None:
    state = carried()
    leading(state, [tells(16, 0.02)])
    (step,) = leading(state, [tells(17, 0.6)])
    assert step.from_t == 16.0


def test_who_walks_is_led_by_his_unit() -> None:
    readings = [tells(2, 0.7, 1.0)]
    assert leading(fused([entered(node="ff1")]), readings) == readings


def test_a_unit_that_is_not_where_its_radio_is_goes_on_by_itself() -> None:
    state = carried()
    apart = SeparatedUnit(15.0, (5.0, 0.0), 0.0, ((15.0, 0.0, 0.0),))
    state.nodes["ff1"] = replace(state.nodes["ff1"], apart=apart, carried_t=None)
    before = state.counts["not_fused"]
    assert leading(state, [tells(16, 0.6, 15.0)]) == []
    known = state.nodes["ff1"].apart
    assert known is not None
    assert known.marks[-1] == (16.0, 0.6, 0.0)
    assert state.counts["not_fused"] == before + 1
