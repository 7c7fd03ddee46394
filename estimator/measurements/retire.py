"""`retire`: a node has left, burned, or is lost for good."""

from estimator.measurements.base import Identifier, LongText, Reading


class Retire(Reading, tag="retire", frozen=True):
    """The node is marginalised; its past stays.

    Attributes:
        node: the node.
        reason: why.
    """

    node: Identifier
    reason: LongText | None = None
