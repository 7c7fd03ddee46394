"""Where to go from an estimate: along Newton's step, and on along what was gone before.

Newton's steps leave out curvature that is not positive, and that weights change with residuals (EM): each is
too short by about the same share, and the solution comes to rest slowly. Directions that are conjugate to the
one before come to rest in fewer: conjugate gradients with the normal equations as preconditioner (Polak and
Ribière 1969; for EM Jamshidian and Jennrich 1993).
"""

from typing import NamedTuple

from estimator.graph.dense import Array


class NewtonStep(NamedTuple):
    """Newton's step from an estimate.

    Attributes:
        step: flat.
        slope: gradient of the log likelihood there, flat.
        promised: half the product of both, which a parabola gains by it.
    """

    step: Array
    slope: Array
    promised: float


class Direction(NamedTuple):
    """Where to go from an estimate.

    Attributes:
        step: flat.
        promised: half its product with the slope.
    """

    step: Array
    promised: float


def conjugate_step(newton: NewtonStep, before: NewtonStep, gone: Array) -> Direction:
    """The direction that is conjugate to the one before; Newton's step where that one does not help.

    Args:
        newton: the step from here.
        before: the step from the estimate before.
        gone: the direction from there, flat, which was followed as far as it gains.
    """
    turned = 2.0 * newton.promised - float(newton.step @ before.slope)
    if turned > 0.0 and before.promised > 0.0:
        step = newton.step + turned / (2.0 * before.promised) * gone
        promised = 0.5 * float(newton.slope @ step)
        if promised > 0.0:
            return Direction(step, promised)
    return Direction(newton.step, newton.promised)
