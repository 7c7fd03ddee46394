"""What an eliminated chain tells of its determinant, against the dense one."""

import numpy as np
import pytest

from tests.estimator.smoothing.random_chains import SHAPES, Shape, alone, random_chain
from tests.estimator.smoothing.windows import dense


@pytest.mark.parametrize("shape", [*SHAPES, alone(1, 3, 2), alone(1, 4, 0)])
def test_what_walks_and_border_add_to_the_determinant_is_all_of_it(shape: Shape) -> None:
    chain = random_chain(shape)
    _, expected = np.linalg.slogdet(dense(chain)[0])
    chain.reduce()
    walks, border = chain.log_determinants()
    assert len(walks) == shape.width // shape.size
    assert walks.sum() + border == pytest.approx(expected, rel=1e-9)


def test_of_walks_that_nothing_couples_each_adds_its_own_determinant() -> None:
    whole, _ = dense(random_chain(Shape(5, 3, 0, (((0, 2), ()), ((1,), ())))))
    chain = random_chain(Shape(5, 3, 0, (((0, 2), ()), ((1,), ()))))
    chain.reduce()
    own = np.arange(len(whole)).reshape(5, 3, 3)[:, 1].ravel()
    assert chain.log_determinants()[0][1] == pytest.approx(np.linalg.slogdet(whole[np.ix_(own, own)])[1])


def test_what_is_eliminated_to_its_end_is_not_taken_for_what_is_left_of_a_keyframe() -> None:
    chain = random_chain(SHAPES[0])
    chain.reduce()
    with pytest.raises(ValueError, match="assemble the chain anew"):
        chain.remainder(SHAPES[0].length - 1)
