"""Recordings to samples: tables, JSON lines, bags and logs of messages, memory.

What cannot be read is a `TraceError` wherever it is found, a package that lacks an `RvmonError`.

Here are their formats by file name; it imports next to nothing, as what starts fast needs it.
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
"""File name endings and the formats of messages they stand for; a bag of ROS 2 is a folder."""

FORMATS = {
    ".csv": "csv",
    ".jsonl": "jsonl",
    ".ndjson": "jsonl",
    ".parquet": "parquet",
    **MESSAGE_FORMATS,
}
"""File name endings and the formats they stand for; standard input (`-`) is JSON lines."""

DATABASES = (".dbc", ".kcd", ".sym", ".arxml")  # endings of files that say what frames of CAN hold


def frame_databases(path: str | os.PathLike[str]) -> list[str]:
    """The files beside a log of CAN that say what its frames hold; none beside others."""
    folder, name = os.path.split(path)
    if MESSAGE_FORMATS.get(os.path.splitext(name)[1].lower()) not in ("can", "mdf"):
        return []
    found = (one for one in os.listdir(folder or ".") if one.lower().endswith(DATABASES))
    return [os.path.join(folder, one) for one in sorted(found)]


ARRAYS = frozenset({"hdf5", "mat"})  # the formats in which the stamps are an array among others

TOPICS = "topics.toml"
"""In a folder of tables that are one recording: says which file is which topic."""

_FOLDERS = {"metadata.yaml": "ros2", TOPICS: "tables"}

MESSAGE_FORMS = frozenset({*MESSAGE_FORMATS.values(), *_FOLDERS.values()})
"""The formats of messages."""


def form_of_folder(path: str) -> str:
    """The format of a folder that is one recording; empty of other folders, and of files."""
    if not os.path.isdir(path):
        return ""
    found = (form for name, form in _FOLDERS.items() if os.path.isfile(os.path.join(path, name)))
    return next(found, "")
