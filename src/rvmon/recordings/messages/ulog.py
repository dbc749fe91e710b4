"""Reader of PX4 logs (ULog); needs pyulog, the extra `px4`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from rvmon.errors import TraceError, needed
from rvmon.recordings.messages import Topic, errors_as_damage
from rvmon.recordings.messages.column_topics import (
    ColumnMessages,
    ColumnTopic,
    distinct,
    joined,
    leaves_of,
)
from rvmon.recordings.table_recording import ticks_of_column
from rvmon.trace.sample import Outage
from rvmon.trace.stamps import stamps_of
from rvmon.trace.time import TIME_LIMIT

_STAMPS = stamps_of("timestamp:us")
_PER_STAMP = 1_000
_PER_DURATION = 1_000_000
"""Ticks in the unit of stamps, a microsecond, and in that of dropouts, a millisecond."""

_HEADER = 3  # bytes before each message: its length and its type


class _Watched:
    """A file that notes whether reading ended inside a message, which the library ignores.

    The library stops at the end of the file, or at a message that is too short for its type.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.is_cut = False

    def read(self, size: int) -> bytes:
        data = self._file.read(size)
        self.is_cut = bool(data) or size != _HEADER
        return data

    def seek(self, *place: int) -> int:
        return self._file.seek(*place)

    def tell(self) -> int:
        return self._file.tell()

    def close(self) -> None:
        self._file.close()


def ulog_messages(path: Path) -> ColumnMessages:
    """Open a log.

    Raises:
        TraceError: the file is no ULog file, or damaged.
        RvmonError: pyulog is not installed.
        OSError: the file cannot be opened.
    """
    with needed("ULog", "pyulog"):
        from pyulog import ULog
    with open(path, "rb") as file, redirect_stdout(StringIO()):
        watched = _Watched(file)
        with errors_as_damage("ULog"):
            log = ULog(watched)
            start = log.start_timestamp * _PER_STAMP
            called = [
                f"/{data.name}_{data.multi_id}" if data.multi_id else f"/{data.name}"
                for data in log.data_list
            ]
            names = zip(distinct(called), log.data_list, strict=True)
            read = [_topic(name, data, start) for name, data in names]
    if log.file_corruption:
        raise TraceError("is damaged: parts of it are not ULog messages: copy it again")
    end = max((int(one.load()[0].max(initial=0)) for one, _ in read), default=0)
    outages = [outage for _, outage in read if outage is not None]
    outages += [
        Outage(
            dropout.timestamp * _PER_STAMP,
            dropout.timestamp * _PER_STAMP + max(1, dropout.duration) * _PER_DURATION,
            "the logger dropped messages",
        )
        for dropout in log.dropouts
    ]
    if watched.is_cut:
        outages.append(Outage(end, end + 1, "it ends within a message"))
    return ColumnMessages([topic for topic, _ in read], end + watched.is_cut, outages)


def _topic(name: str, data: Any, start: int) -> tuple[ColumnTopic, Outage | None]:
    """A topic of a log, and its outage if some messages have no stamp.

    The time of a message without a stamp (a stamp of 0) is not known, so the topic has an outage up
    to its first stamp.
    """
    camel = "".join(part.capitalize() for part in re.split(r"[/_]", data.name))
    columns = joined(_texts(data))
    times = ticks_of_column(data.data["timestamp"], _STAMPS)
    topic = Topic(name, f"px4_msgs/msg/{camel}", leaves_of(columns))
    is_stamped = times > 0
    outage = None
    if not is_stamped.all():
        times, columns = (
            times[is_stamped],
            {path: column[is_stamped] for path, column in columns.items()},
        )
        until = int(times.min()) - 1 if len(times) else TIME_LIMIT - 1
        lost = frozenset({name})
        outage = Outage(start, max(start, until), "messages have no stamp", lost)
    return ColumnTopic(topic, len(times), lambda: (times, columns)), outage


def _texts(data: Any) -> Mapping[str, Any]:
    """The columns of a topic, with characters joined to texts, and truth values as bool."""
    found: dict[str, Any] = {}
    texts: dict[str, list[Any]] = {}
    for field in data.field_data:
        path, column = field.field_name, data.data[field.field_name]
        if path == "timestamp" or path.rpartition(".")[2].startswith("_padding"):
            continue
        if field.type_str == "char":
            texts.setdefault(re.sub(r"\[\d+\]$", "", path), []).append(column)
        else:
            found[path] = column.astype(bool) if field.type_str == "bool" else column
    for path, parts in texts.items():
        rows = np.stack(parts, axis=1).astype(np.uint8)
        found[path] = np.array(
            [bytes(row).partition(b"\0")[0].decode("utf-8", "replace") for row in rows], object
        )
    return found
