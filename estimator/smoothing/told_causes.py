"""All that was told and may be wrong, asked together: what one explains may be no fault of another."""

import math
from collections.abc import Mapping
from typing import NamedTuple

from estimator.fusion.learned.told_places import MistoldPlace
from estimator.fusion.memory.state import FusionState
from estimator.smoothing.changes.told_fixes import (
    DOUBTED,
    ToldFixes,
    allow,
    ask_told_fixes,
    doubt_fixes,
    misled,
)
from estimator.smoothing.changes.told_places import (
    ToldPlace,
    ask_told_places,
    doubts_of,
    free,
    is_doubted,
    mistold,
)
from estimator.smoothing.learning.delays import delay_odds
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution


class Causes(NamedTuple):
    """What may be wrong.

    Attributes:
        places: told places, the likeliest first.
        fixes: fixes of those who fly, the likeliest first.
        delays: log odds that the radio of a node has an antenna delay.
    """

    places: list[ToldPlace]
    fixes: list[ToldFixes]
    delays: Mapping[str, float]

    @property
    def odds(self) -> float:
        """Log odds of the likeliest one that is no delay."""
        places, fixes = ([one.odds for one in told] for told in (self.places, self.fixes))
        return max(places + fixes, default=-math.inf)

    @property
    def doubted(self) -> bool:
        """Whether any of them may be wrong at all."""
        return is_doubted(self.places) or bool(self.fixes and self.fixes[0].odds > DOUBTED)

    @property
    def wrong(self) -> bool:
        """Whether one of them is likelier to be wrong than all of them to be right."""
        return self.odds > 0.0

    def besides_places(self) -> dict[str, float]:
        """Log odds of all that explains what a wrong place does."""
        return {**self.delays, **{one.known_by: one.odds for one in self.fixes}}

    def besides_fixes(self) -> dict[str, float]:
        """Log odds of all that explains what wrong fixes do."""
        return {**self.delays, **{f"{one.name} stands": one.odds for one in self.places}}

    def doubted_places(self) -> dict[str, MistoldPlace]:
        """What is to be told of places that may be wrong."""
        return doubts_of(self.places, self.besides_places())

    def doubt(self, state: FusionState) -> None:
        """Let covariances hold what may be wrong."""
        state.mistold = self.doubted_places()
        doubt_fixes(state, self.fixes, self.besides_fixes())

    def correct(self, state: FusionState) -> bool:
        """Let go of the one that is wrong, if it stands out; the window is then to be solved again."""
        place, fixes = mistold(self.places, self.besides_places()), misled(self.fixes, self.besides_fixes())
        if place is not None and state.life(place.number).index == place.number:
            free(state, place, self.delays.get(place.name, -math.inf))
            return True
        if fixes is not None:
            allow(state, fixes)
            return True
        return False


NONE = Causes([], [], {})


def ask(problem: Problem, solved: Solution) -> Causes:
    """How likely each of them is to be wrong.

    Args:
        problem: of a window, or of the whole incident.
        solved: its solution, at rest.
    """
    places, fixes = ask_told_places(problem, solved), ask_told_fixes(problem, solved)
    causes = Causes(places, fixes, {})
    return causes._replace(delays=delay_odds(problem, solved)) if causes.doubted else causes
