"""Reader of vehicle measurements (MDF 4, `.mf4`); needs asammdf, the extra `mdf`."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from functools import partial
from heapq import merge
from io import StringIO
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from rvmon.errors import TraceError, needed
from rvmon.recordings.messages import Topic, column_topics, errors_as_damage
from rvmon.recordings.table_recording import ticks_of_column
from rvmon.trace.schema import Stamps

_STAMPS = Stamps("its time", "s", is_stated=True)

_IN_TIME = 1  # the mark of a master channel that counts seconds
_FRAMES = "CAN_DataFrame"  # the channel of a group that holds raw CAN frames

_LAST_STANDARD = 0x7FF
_IDENTIFIER = 0x1FFFFFFF


def open_measurement(path: Path) -> Any:
    """Open a file with the library.

    Raises:
        TraceError: the file is not an MDF file, or damaged.
        RvmonError: asammdf is not installed.
        OSError: the file cannot be opened.
    """
    with needed("MDF", "asammdf"):
        from asammdf import MDF
    with open(path, "rb") as file:
        if not file.read(8).startswith((b"MDF", b"UnFinMF")):
            raise TraceError("is not an MDF file: it does not start like one")
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)
    with errors_as_damage("MDF"), _quietly_freed():
        return MDF(path)


def mdf_messages(path: Path) -> column_topics.ColumnMessages | None:
    """Open a measurement; `None` if it holds only raw CAN frames.

    Stamps count from the start of the measurement. Errors are those of `open_measurement`.
    """
    file = open_measurement(path)
    with errors_as_damage("MDF"):
        groups = [one for one, group in enumerate(file.groups) if group.channel_group.cycles_nr]
        kept = [group for group in groups if not _holds_frames(file.groups[group])]
        if groups and not kept:
            file.close()
            return None
        channels = {one: file.groups[one].channel_group for one in kept}
        called = [own.acq_name or own.comment or f"group_{one}" for one, own in channels.items()]
        lines = [name.partition("\n")[0] for name in called]
        names = [f"/{column_topics.path_of(line)}" for line in lines]
        topics = [_topic(file, name, one) for name, one in zip(names, kept, strict=True)]
        ends = [int(_times(file, one).max()) for one in kept if _counts_time(file, one)]
    return column_topics.ColumnMessages(topics, max(ends, default=None), close=file.close)


def _holds_frames(group: Any) -> bool:
    return any(channel.name == _FRAMES for channel in group.channels)


def mdf_frames(path: Path) -> Iterator[tuple[int, tuple[int, bool], int, bytes]]:
    """Yield ticks, identifier, channel and data of each CAN frame in a measurement, by time.

    Errors are those of `open_measurement`.
    """
    file = open_measurement(path)
    try:
        found = []
        for number, group in enumerate(file.groups):
            if not (group.channel_group.cycles_nr and _holds_frames(group)):
                continue
            times = _times(file, number)
            columns = {
                channel.name.removeprefix(f"{_FRAMES}."): place
                for place, channel in enumerate(group.channels)
            }

            def of(name: str, number: int = number, columns: Any = columns) -> Any:
                with errors_as_damage("MDF"):
                    return _signal(file, number, columns[name]).samples

            length = of("DataLength" if "DataLength" in columns else "DLC")
            identifier = of("ID").astype(np.int64)
            is_extended = of("IDE") if "IDE" in columns else identifier > _LAST_STANDARD
            channel = of("BusChannel") if "BusChannel" in columns else np.zeros(len(times))
            whole = [one.astype(np.int64) for one in (times, identifier, channel, length)]
            parts = [one.tolist() for one in (*whole, is_extended.astype(bool))]
            found.append((*parts, of("DataBytes")))
        rows = (zip(*group, strict=True) for group in found)
        for t, identifier, channel, length, is_extended, data in merge(*rows, key=itemgetter(0)):
            yield t, (identifier & _IDENTIFIER, is_extended), channel, bytes(data[:length])
    finally:
        file.close()


@contextmanager
def _quietly_freed() -> Iterator[None]:
    """Keep the library's destructor from failing: it closes a file again that it could not open."""
    try:
        yield
    except Exception as error:
        trace = error.__traceback__
        while trace is not None:
            owner: Any = trace.tb_frame.f_locals.get("self")
            if type(owner).__name__ == "MDF4":
                owner.close = int
                if temporary := getattr(owner, "_tempfile", None):
                    temporary.close()
            trace = trace.tb_next
        raise


def _counts_time(file: Any, group: int) -> bool:
    master = file.masters_db.get(group)
    return master is not None and file.groups[group].channels[master].sync_type == _IN_TIME


def _times(file: Any, group: int) -> Any:
    with errors_as_damage("MDF"):
        times = ticks_of_column(np.asarray(file.get_master(group), np.float64), _STAMPS)
    counted = file.groups[group].channel_group.cycles_nr
    if len(times) != counted:
        raise TraceError(
            f"holds {len(times):,} records of a group, but its header counts {counted:,}: "
            "copy it again"
        )
    return times


def _signal(file: Any, group: int, index: int, **options: Any) -> Any:
    """Read a channel with its invalid values, which the library leaves out by default."""
    with redirect_stdout(StringIO()):  # the library prints what it knows of an unreadable channel
        return file.get(group=group, index=index, ignore_invalidation_bits=True, **options)


def _channel(file: Any, group: int, index: int) -> tuple[Any, Any]:
    signal = _signal(file, group, index)
    values, invalid = signal.samples, signal.invalidation_bits
    if values.dtype.kind == "S":
        values = np.char.rstrip(values, b"\0 ")
    return values, None if invalid is None else invalid.tolist()


def _topic(file: Any, name: str, group: int) -> column_topics.ColumnTopic:
    """The topic of a group of channels, which share one clock."""
    counted = file.groups[group].channel_group.cycles_nr
    kind = file.groups[group].channel_group.acq_source
    type_name = kind.name if kind is not None and kind.name else "MDF"
    if not _counts_time(file, group):
        topic = Topic(name, type_name, {}, "its channels do not count by time")
        return column_topics.ColumnTopic(topic, counted, lambda: (np.zeros(0, np.int64), {}))
    listed = [
        (place, channel)
        for place, channel in enumerate(file.groups[group].channels)
        if place != file.masters_db[group]
    ]
    paths = column_topics.distinct([column_topics.path_of(channel.name) for _, channel in listed])
    columns = {}
    for path, (place, _) in zip(paths, listed, strict=True):
        first = _signal(file, group, place, record_count=1)
        if first.samples.dtype.names:
            continue  # a structure, whose members are channels as well
        read, unit = partial(_channel, file, group, place), (first.unit or "").strip()
        columns[path] = column_topics.LateColumn(
            "MDF", read, first.samples.dtype, first.samples.ndim, unit
        )
    leaves, units = column_topics.leaves_of(columns), column_topics.units_of(columns)
    topic = Topic(name, type_name, leaves, units=units)
    return column_topics.ColumnTopic(topic, counted, lambda: (_times(file, group), columns))
