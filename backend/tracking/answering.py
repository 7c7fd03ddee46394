"""Questions that only the joint covariance can answer."""

from backend.coordination.base import Answer, Query
from backend.tracking.fold import IncidentFold


def answer(fold: IncidentFold, query: Query) -> Answer:
    """What a fold has to say to a question."""
    try:
        relative = fold.relative(query.a, query.b)
    except KeyError as error:
        return Answer(query.number, found=False, unknown=True, detail=f"There is no node {error.args[0]!r}.")
    if relative is None:
        return Answer(query.number, found=False, detail="The position of one of them is not decided yet.")
    return Answer(query.number, found=True, delta_m=relative.delta_m, covariance_m2=relative.covariance_m2)
