"""Public data sets as recorded logs: one file a data set, with `NAME`, `RECORDINGS` and `readings`."""

import importlib
import pkgutil
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from backend.errors import CommandRefused
from backend.recordings.datasets.base import NotTheDataSet, lines

__all__ = ["NotTheDataSet", "convert", "converter_names"]


def converter_names() -> list[str]:
    """What `convert` takes: a data set, or `dataset:recording` where it holds several."""
    return sorted(name for module in _modules().values() for name in _names(module))


def convert(name: str, folder: Path) -> Iterator[bytes]:
    """The NDJSON lines of a data set: batches of about a second, `t` as recorded, ready to be posted.

    Args:
        name: one of `converter_names()`; of a data set with several recordings the bare name means the first.
        folder: the data set's folder.

    Raises:
        CommandRefused: there is no such data set or recording.
        NotTheDataSet: the folder does not hold it.
    """
    data_set, _, recording = name.partition(":")
    module = _modules().get(data_set)
    if module is None or (recording and recording not in module.RECORDINGS):
        raise CommandRefused(f"no data set {name!r}; there are {', '.join(converter_names())}")
    chosen = recording or next(iter(module.RECORDINGS), None)
    return lines(data_set, module.readings(folder, chosen))


def _names(module: ModuleType) -> list[str]:
    return [f"{module.NAME}:{recording}" for recording in module.RECORDINGS] or [module.NAME]


def _modules() -> dict[str, ModuleType]:
    found = [importlib.import_module(f"{__name__}.{info.name}") for info in pkgutil.iter_modules(__path__)]
    return {module.NAME: module for module in found if hasattr(module, "NAME")}
