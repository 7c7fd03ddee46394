"""The solutions of a window that images of somebody's way lead to.

Most images lead back to where he was: first the window is solved with all others held where they are, which
costs little, and as a whole only where that has led elsewhere.
"""

from collections.abc import Iterable, Sequence

from estimator.fusion.images import Image
from estimator.smoothing.earlier import CLEARER, ITERATIONS
from estimator.smoothing.flips import Flip
from estimator.smoothing.solved import Solved
from estimator.smoothing.tried import Asked, Begun, Tried
from estimator.smoothing.walks import Motion

SOON = 4
"""Iterations after which an image is given up that is hopeless."""
HOPELESS, HELD = 50.0, 150.0
"""What an image costs more, in log likelihood, that is given up; and with all others held where they are."""
SLACKS_M = (1.0, 0.3, 0.1)
"""How far off an estimate may be at first whose way nobody has gone: with a unit turned, or others along."""


def solutions(asked: Asked, solved: Solved, begun: Iterable[Begun], most: int) -> list[Tried]:
    """The solutions that images of a way lead to, that which is to be shown first.

    Args:
        asked: of whom.
        solved: the solution of which they are images.
        begun: where each of them begins, with all others where they are in the solution.
        most: so many of them are solved as a whole.
    """
    found, tried = [Tried(solved, Flip(0, Image()))], list[Begun]()
    for start in begun:
        if any(asked.same_start(start, other) for other in tried):
            continue
        tried.append(start)
        led = _led(asked, solved.motions, found, start)
        if led is None:
            continue
        if most == 0:
            break
        most -= 1
        there = _solved(asked, found, led)
        if there is None:
            continue
        new = Tried(there, start.flip)
        same = asked.among(found, new)
        if same is None:
            found.append(new)
        elif there.cost < found[same].solved.cost - CLEARER:
            found[same] = new._replace(flip=found[same].flip)
    best = min(found, key=lambda one: one.solved.cost)
    if best.solved.cost > found[0].solved.cost - CLEARER:
        best = found[0]
    return [best, *(one for one in found if one is not best)]


def _led(asked: Asked, motions: Sequence[Motion], found: Sequence[Tried], start: Begun) -> Begun | None:
    """Where an image leads to with all others held where they are; None: to no solution that is not known."""
    problem, moving = asked.problem, {asked.of, *(i for i, _ in start.flip.along)}
    if len(moving) == len(problem.layout.walks):
        return start
    slacks = _slacks(start.flip)
    try:
        led = problem.beside(moving, motions).solve(start.x, slacks, len(slacks) + SOON)
    except ValueError:
        # It hangs in the air there.
        return None
    if led.cost > found[0].solved.cost + HELD:
        return None
    same = asked.among(found, Tried(led, start.flip))
    if same is not None and led.cost > found[same].solved.cost - CLEARER:
        return None
    return start._replace(x=led.x)


def _solved(asked: Asked, found: Sequence[Tried], start: Begun) -> Solved | None:
    """The solution from an image; None where there is none, or it is hopeless."""
    problem, slacks = asked.problem, _slacks(start.flip)
    try:
        there = problem.solve(start.x, slacks, len(slacks) + SOON)
        if there.cost > found[0].solved.cost + HOPELESS:
            return None
        return there if there.rests else problem.solve(there.x, iterations=ITERATIONS)
    except ValueError:
        # It hangs in the air there.
        return None


def _slacks(flip: Flip) -> tuple[float, ...]:
    """What others, or what a unit faces, have been turned by is hardly more than a guess."""
    return SLACKS_M if flip.along or flip.image.turned_rad != 0.0 else ()
