"""What all readings share: identifiers, epochs, bounds, and the struct they derive from."""

from typing import Annotated

import msgspec
from msgspec import Meta

Identifier = Annotated[str, Meta(min_length=1, max_length=64, pattern=r"^[A-Za-z0-9_.:-]+\Z")]
"""A node, gateway, batch or technology: 1 to 64 of ``A-Za-z0-9_.:-``."""

LATEST_T = 4_102_444_800.0
"""The year 2100, Unix seconds."""

EpochSeconds = Annotated[float, Meta(ge=0.0, le=LATEST_T)]
"""Unix seconds, from 1970 to 2100: wide enough for recordings that count from zero."""

LengthM = Annotated[float, Meta(ge=-100_000.0, le=100_000.0)]
"""A coordinate or displacement in metres: an incident is local, 100 km is beyond any."""

SigmaM = Annotated[float, Meta(gt=0.0, le=100_000.0)]
AngleRad = Annotated[float, Meta(ge=-1_000.0, le=1_000.0)]
"""An angle in radians; units may report it unwrapped, over many turns."""

SigmaRad = Annotated[float, Meta(gt=0.0, le=100.0)]

Vector3M = tuple[LengthM, LengthM, LengthM]
Sigma3M = tuple[SigmaM, SigmaM, SigmaM]
ShortText = Annotated[str, Meta(max_length=200)]
LongText = Annotated[str, Meta(max_length=4_000)]


class Reading(
    msgspec.Struct,
    frozen=True,
    forbid_unknown_fields=True,
    tag_field="kind",
    omit_defaults=True,
    kw_only=True,
    gc=False,  # nothing in it can refer to it: it need not be searched for circles
):
    """One reading as a gateway posts it.

    Attributes:
        t: the epoch that the reading refers to, Unix seconds.
    """

    t: EpochSeconds

    @property
    def until_t(self) -> float:
        """Epoch up to which it tells something, Unix seconds."""
        return self.t


class SelfReading(ValueError):  # noqa: N818 - names the condition
    """A reading in which a node measures or drops itself."""


class PairReading(Reading, frozen=True):
    """A reading between two nodes, which must differ.

    Attributes:
        a: the node that measures.
        b: the node that is heard or seen.
    """

    a: Identifier
    b: Identifier

    def __post_init__(self) -> None:
        """Refuse a node that measures itself.

        Raises:
            SelfReading: `a` and `b` are the same node.
        """
        if self.a == self.b:
            raise SelfReading(f"`a` and `b` are both {self.a!r}: a node cannot measure itself")
