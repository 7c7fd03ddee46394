"""`drop`: a responder has just dropped a breadcrumb where it stands."""

from estimator.measurements.base import Identifier, Reading, SelfReading


class Drop(Reading, tag="drop", frozen=True):
    """A breadcrumb now lies where the responder stands.

    Attributes:
        node: the breadcrumb.
        by: the responder that dropped it.
    """

    node: Identifier
    by: Identifier

    def __post_init__(self) -> None:
        """Refuse a node that drops itself.

        Raises:
            SelfReading: `node` and `by` are the same.
        """
        if self.node == self.by:
            raise SelfReading(f"`node` and `by` are both {self.node!r}: a node cannot drop itself")
