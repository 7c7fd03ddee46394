"""Recorded logs: import, export, and conversion of public data sets."""

from backend.recordings.datasets import NotTheDataSet, convert, converter_names
from backend.recordings.ndjson import Imported, export_log, import_log
from backend.recordings.options import parse_level, parse_origin, parse_settings

__all__ = [
    "Imported",
    "NotTheDataSet",
    "convert",
    "converter_names",
    "export_log",
    "import_log",
    "parse_level",
    "parse_origin",
    "parse_settings",
]
