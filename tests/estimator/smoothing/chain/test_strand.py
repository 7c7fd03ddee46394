"""How the strands of a chain lie in memory."""

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.smoothing.chain.strand import Strand, strands_of
from tests.estimator.smoothing.random_chains import SHAPES, Shape, groups_of


def blocks_of(strand: Strand) -> list[Array]:
    return [strand.diagonal, strand.link, strand.wide, strand.corner, strand.corner_gradient]


@pytest.mark.parametrize("shape", SHAPES)
def test_the_strands_of_a_chain_are_nil_and_fill_one_block_of_memory_side_by_side(shape: Shape) -> None:
    blocks = [block for one in strands_of(shape.length, groups_of(shape)) for block in blocks_of(one)]
    whole = blocks[0].base
    assert whole is not None
    assert all(block.base is whole for block in blocks)
    assert sum(block.size for block in blocks) == whole.size
    for number, block in enumerate(blocks):
        assert not block.any()
        block[...] = number + 1.0
    for number, block in enumerate(blocks):
        assert (block == number + 1.0).all()
        assert block.flags.c_contiguous


def test_a_strand_has_the_numbers_of_its_walks_and_of_what_they_touch() -> None:
    shape = Shape(9, 3, 6, (((0, 3), (0, 1, 4)), ((1,), (1, 2, 4))))
    first, second, rest = strands_of(shape.length, groups_of(shape))
    assert [block.shape for block in blocks_of(first)] == [(9, 6, 6), (8, 2, 3, 3), (9, 6, 4), (3, 3), (3,)]
    assert second.border.shape == (9, 3, 3)
    assert rest.corner.shape == (6, 6)
    assert not np.prod(rest.diagonal.shape)
