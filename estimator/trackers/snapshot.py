"""Snapshots of trackers: the version that wrote one stands in front of everything else in it."""

from typing import TypeVar

import msgspec

Form = TypeVar("Form", bound=msgspec.Struct)


class _Version(msgspec.Struct, frozen=True, array_like=True):
    version: int


def read_snapshot(state: bytes, form: type[Form], version: int) -> Form:
    """A snapshot as values; one that is refused is of no use: the log is to be folded anew.

    Args:
        state: what the tracker's `snapshot` gave.
        form: what stands in it, as an array whose first value is the version.
        version: the one that this tracker writes and reads.

    Raises:
        ValueError: `state` was written by another version, or is no snapshot.
    """
    try:
        written = msgspec.msgpack.decode(state, type=_Version).version
        if written != version:
            raise ValueError(
                f"the snapshot is of version {written}, this tracker reads {version}: fold the log anew"
            )
        return msgspec.msgpack.decode(state, type=form)
    except msgspec.DecodeError as error:
        raise ValueError(f"this is no snapshot of the tracker: {error}") from error
