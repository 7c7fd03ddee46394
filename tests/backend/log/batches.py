"""Batches for tests of the log."""

from collections.abc import Sequence
from dataclasses import dataclass

from backend.errors import FieldError, Problem
from backend.log.base import Appended, NewBatch


@dataclass(frozen=True)
class MakeBatch:
    """Makes a batch of an incident; what is not given does not matter."""

    incident: str

    def __call__(
        self,
        name: str,
        *,
        gateway: str = "g",
        incident: str | None = None,
        body: bytes | None = None,
        accepted: int = 1,
        rejected: tuple[FieldError, ...] = (),
        received: float = 1.0,
        sent: float | None = None,
    ) -> NewBatch:
        if body is None:
            body = b'{"gateway":"%s","batch":"%s","readings":[]}' % (gateway.encode(), name.encode())
        return NewBatch(
            incident=incident or self.incident,
            gateway=gateway,
            batch=name,
            received=received,
            sent=sent,
            body=body,
            accepted=accepted,
            rejected=rejected,
        )


def appended(outcomes: Sequence[Appended | Problem]) -> list[Appended]:
    """The outcomes, all of which must be acknowledgements."""
    done = [outcome for outcome in outcomes if isinstance(outcome, Appended)]
    assert len(done) == len(outcomes), outcomes
    return done


def seqs(outcomes: Sequence[Appended | Problem]) -> list[int]:
    """The places in the log, all of which must have been given."""
    return [one.seq for one in appended(outcomes)]
