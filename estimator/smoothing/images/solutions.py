"""The solutions of a window that images of somebody's way lead to.

Most images lead back to where he was: first those who would go there are solved by themselves, with all the
others held where they are, which costs little, and the window as a whole only where that has led elsewhere.
"""

import math
from collections.abc import Iterable

import numpy as np

from estimator.fusion.images import Image
from estimator.smoothing.images.earlier_images import CLEARER
from estimator.smoothing.images.flip_ambiguity import Flip
from estimator.smoothing.images.image_starts import ImageEnd, ImageSolution, ImageStart, Subject
from estimator.smoothing.images.local_solution import SOON, local_solution
from estimator.smoothing.images.parts import Parts
from estimator.smoothing.problem.solution import Solution

HELD, ALONE = 150.0, 10.0
"""What an image costs more, in log likelihood, that is given up with all others held where they are; and so
where no reading ties him to any of them."""
FAR = 600.0
"""What an image costs more, in log likelihood, that is not solved at all."""
LED = 4
"""So many times as many images are solved with all others held as are solved as a whole at most."""
SLACKS_M = (1.0, 0.3, 0.1)
"""How far off an estimate may be at first whose way nobody has gone: with a unit turned, or others along."""


def solutions(
    asked: Subject, parts: Parts, solved: Solution, begun: Iterable[ImageStart], most: int
) -> list[ImageSolution]:
    """The solutions that images of a way lead to, that which is to be shown first.

    Args:
        asked: of whom.
        parts: of the window, with all others where they are in the solution.
        solved: the solution of which they are images.
        begun: where each of them begins, with all others where they are in the solution.
        most: so many of them are solved as a whole.
    """
    found, tried, led = [ImageSolution(solved, Flip(0, Image()))], list[ImageStart](), list[ImageEnd]()
    tied = _tied(asked)
    for start in begun:
        if any(asked.same_start(start, other) for other in tried):
            continue
        tried.append(start)
        there = _led(asked, parts, found[0], start, tied)
        if there is not None and not any(_same(asked, parts, other, there) for other in led):
            led.append(there)
        if len(tried) == LED * most:
            break
    # What begins far off may lead nearest: what is likeliest with all others held is solved first.
    led.sort(key=lambda one: one.cost)
    for start, cost in led[:most]:
        # With nobody held it has led nowhere yet: it is as far off as what it is an image of.
        slacks = SLACKS_M if cost == math.inf else ()
        solution = local_solution(asked.problem, start.x, slacks, found[0].solved)
        if solution is None:
            continue
        new = ImageSolution(solution, start.flip)
        same = asked.among([one.led for one in found], new.led)
        if same is None:
            found.append(new)
        elif solution.cost < found[same].solved.cost - CLEARER:
            found[same] = new._replace(flip=found[same].flip)
    best = min(found, key=lambda one: one.solved.cost)
    if best.solved.cost > found[0].solved.cost - CLEARER:
        best = found[0]
    return [best, *(one for one in found if one is not best)]


def _led(
    asked: Subject, parts: Parts, known: ImageSolution, start: ImageStart, tied: bool
) -> ImageEnd | None:
    """Where an image leads to with all others held where they are; None: to no solution that is not known.

    Two headings part soon, or they are one: first the beginning of a way is asked alone.

    Args:
        asked: of whom.
        parts: of the window.
        known: the solution that is known.
        start: where to begin.
        tied: readings tie him to others who move.
    """
    layout, moving = asked.layout, {asked.of, *(i for i, _ in start.flip.along)}
    slacks, last = _slacks(start.flip), layout.length - 1
    led = ImageEnd(start, math.inf)
    for until in parts.stages(start.flip):
        if until == last and len(moving) == len(layout.walks):
            return led._replace(cost=math.inf)
        part = parts.of(moving, until)
        try:
            x = part.led(led.to.x, slacks, len(slacks) + SOON)
        except ValueError:
            # It hangs in the air there.
            return None
        led = ImageEnd(start._replace(x=x), part.more(x))
        if led.cost > (HELD if tied else ALONE):
            return None
        home = ImageEnd(known.begun, part.more(known.solved.x))
        if not asked._replace(part=part).same(home, led):
            continue
        # A beginning that is the same goes on the same way: what it gains by itself is no gain.
        clearer = until == last and led.cost < home.cost - CLEARER
        if not clearer and (until == last or asked.returned(home.to, start, led.to)):
            return None
    return led


def _same(asked: Subject, parts: Parts, one: ImageEnd, other: ImageEnd) -> bool:
    """Whether two images have led to the same, with all others held."""
    if math.inf in (one.cost, other.cost):
        return False
    moving = {asked.of, *(i for i, _ in other.to.flip.along)}
    return asked._replace(part=parts.of(moving, asked.layout.length - 1)).same(one, other)


def _tied(asked: Subject) -> bool:
    """Whether readings tie a walk to others who move."""
    walks, pairs = asked.layout.walks, asked.problem.rows.pairs
    own, others = walks[asked.of].number, [walk.number for walk in walks]
    others.remove(own)
    one, other = pairs[:, 2], pairs[:, 3]
    return bool((np.isin(other[one == own], others)).any() or (np.isin(one[other == own], others)).any())


def _slacks(flip: Flip) -> tuple[float, ...]:
    """What others, or what a unit faces, have been turned by is hardly more than a guess."""
    return SLACKS_M if flip.along or flip.image.turned_rad != 0.0 else ()
