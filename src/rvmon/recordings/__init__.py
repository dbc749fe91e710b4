"""Readers that turn recordings into samples: tables, JSON lines, bags, logs of messages, memory.

Every reader raises `TraceError` for input that it cannot read, and `RvmonError` for a package that
is not installed.

This module lists the formats by file name. It imports next to nothing, because programs that must
start fast import it.
"""

from __future__ import annotations

import os

MESSAGE_FORMATS = {
    ".bag": "ros1",
    ".db3": "ros2",
    ".mcap": "mcap",
    ".ulg": "ulog",
    ".bin": "dataflash",
    ".tlog": "tlog",
    ".mf4": "mdf",
    ".asc": "can",
    ".blf": "can",
    ".trc": "can",
    ".log": "can",
    ".h5": "hdf5",
    ".hdf": "hdf5",
    ".hdf5": "hdf5",
    ".mat": "mat",
}
"""The format of messages by file name ending; a bag of ROS 2 is a folder."""

FORMATS = {
    ".csv": "csv",
    ".jsonl": "jsonl",
    ".ndjson": "jsonl",
    ".parquet": "parquet",
    **MESSAGE_FORMATS,
}
"""The format by file name ending; standard input (`-`) is JSON lines."""

DATABASES = (".dbc", ".kcd", ".sym", ".arxml")  # endings of CAN databases, which define frames


def frame_databases(path: str | os.PathLike[str]) -> list[str]:
    """The CAN databases beside a CAN log or an MDF file, sorted; none beside other recordings."""
    folder, name = os.path.split(path)
    if MESSAGE_FORMATS.get(os.path.splitext(name)[1].lower()) not in ("can", "mdf"):
        return []
    found = (one for one in os.listdir(folder or ".") if one.lower().endswith(DATABASES))
    return [os.path.join(folder, one) for one in sorted(found)]


ARRAYS = frozenset({"hdf5", "mat"})  # the formats that store stamps as one array among others

TOPICS = "topics.toml"
"""The file in a folder of tables that names the topic of each table; the folder is a recording."""

_FOLDERS = {"metadata.yaml": "ros2", TOPICS: "tables"}

MESSAGE_FORMS = frozenset({*MESSAGE_FORMATS.values(), *_FOLDERS.values()})
"""The formats of messages."""


def form_of_folder(path: str) -> str:
    """The format of a folder that is one recording; "" for other folders and for files."""
    if not os.path.isdir(path):
        return ""
    found = (form for name, form in _FOLDERS.items() if os.path.isfile(os.path.join(path, name)))
    return next(found, "")
