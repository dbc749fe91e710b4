"""Reader of ArduPilot logs (DataFlash, `.BIN`); needs pymavlink, the extra `mavlink`."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from rvmon.errors import TraceError, needed
from rvmon.recordings.messages import Topic, errors_as_damage
from rvmon.recordings.messages.column_topics import ColumnMessages, Columns, ColumnTopic, leaves_of
from rvmon.recordings.table_recording import ticks_of_column
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Stamps
from rvmon.trace.stamps import stamps_of
from rvmon.trace.time import TICKS_PER_UNIT, TIME_LIMIT

_CODES = "i1 u1 <f2 <i2 <u2 <i4 <u4 <f4 S4 S16 S64 <i2 <u2 <i4 <u4 <i4 <f8 u1 <i8 <u8"
_TYPES = {"a": ("<i2", (32,)), **dict(zip("bBghHiIfnNZcCeELdMqQ", _CODES.split(), strict=True))}
"""NumPy types by the letters of a message format."""

_MAGIC = b"\xa3\x95"
_HEAD = 3
_PAGE = 528  # bytes of a page; less than a page of filling may follow the last message

_ERASED = 0xFF

_STAMPS = tuple(map(stamps_of, ("T:ms", "TimeUS:us", "TimeMS:ms")))
"""The possible stamp fields, by preference. `T` is only for GPS messages, whose `TimeMS` is the
time of the satellites."""

_OF_THE_LOG = frozenset({"FMT", "FMTU", "UNIT", "MULT"})
"""Messages that describe the format of the others."""


def dataflash_messages(path: Path) -> ColumnMessages:
    """Open a log.

    Raises:
        TraceError: the file is not a DataFlash log, or its formats are damaged.
        RvmonError: pymavlink is not installed.
        OSError: the file cannot be opened.
    """
    with needed("DataFlash", "pymavlink"):
        from pymavlink.DFReader import DFReader_binary

    class Indexed(DFReader_binary):  # type: ignore[misc]  # it has no types
        """The index of the messages of a log, by the library."""

        def init_clock(self) -> None:
            """Do nothing: the library would read all messages, and hang at one of length 0."""

    with open(path, "rb") as file:
        if file.read(2) != _MAGIC:
            raise TraceError("is not a DataFlash log: it does not start like one")
    with _silent(), errors_as_damage("DataFlash"):
        log = Indexed(str(path))
        data = np.frombuffer(log.data_map, np.uint8)
        starts = {one: _starts(form, data, log.offsets[one]) for one, form in log.formats.items()}
        topics = [
            topic
            for number, form in log.formats.items()
            if len(starts[number]) and form.name not in _OF_THE_LOG
            for topic in _topics(form, data, starts[number])
        ]
        loaded = [topic.load()[0] for topic in topics]
        end = max((int(times.max()) for times in loaded if len(times)), default=0)
        outages = _damage(log, data, starts, end)
    last = max((outage.until for outage in outages), default=end)
    return ColumnMessages(topics, max(end, last), outages, log.filehandle.close)


@contextmanager
def _silent() -> Iterator[None]:
    """Silence the library, which prints a line for each damaged byte, partly from C code."""
    output = StringIO()
    with redirect_stdout(output), redirect_stderr(output), open(os.devnull, "wb") as nowhere:
        shown = os.dup(2)
        os.dup2(nowhere.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(shown, 2)
            os.close(shown)


def _starts(form: Any, data: Any, found: Any) -> Any:
    """The offsets of a format's messages, without damaged ones, whose stamp is out of range."""
    starts = np.asarray(found, np.int64)
    stamps = _stamps_of(form)
    if stamps is None or not len(starts):
        return starts
    is_whole = starts + form.len <= len(data)
    stamped = _rows(form, data, starts[is_whole])[stamps.column]
    most = TIME_LIMIT // TICKS_PER_UNIT[stamps.unit]
    return np.concatenate([starts[is_whole][stamped < most], starts[~is_whole]])


def _rows(form: Any, data: Any, starts: Any) -> Any:
    """The messages of a format at these offsets, as a structured array of raw values.

    Raises:
        TraceError: the format contradicts itself.
    """
    letters = list(form.msg_fmts)
    if len(letters) != len(form.columns):
        raise TraceError(f"its format of {form.name} names fields without a type: copy it again")
    layout = np.dtype(
        [(name, _TYPES[letter]) for name, letter in zip(form.columns, letters, strict=True)]
    )
    if layout.itemsize != form.len - _HEAD:
        raise TraceError(f"its format of {form.name} contradicts its length: copy it again")
    bodies = data[starts[:, None] + np.arange(_HEAD, form.len)]
    return np.ascontiguousarray(bodies).view(layout).reshape(-1)


def _topics(form: Any, data: Any, starts: Any) -> list[ColumnTopic]:
    """The topics of a message format; each instance (of a sensor, say) is a topic of its own."""
    rows = _rows(form, data, starts[starts + form.len <= len(data)])
    stamps = _stamps_of(form)
    if stamps is None or not len(rows):
        return []
    times = ticks_of_column(rows[stamps.column], stamps)
    scales = dict(zip(form.columns, form.msg_mults, strict=True))
    units = dict(zip(form.columns, form.units or [""] * len(form.columns), strict=False))
    instance = form.instance_field
    numbers = [None] if instance is None else np.unique(rows[instance]).tolist()
    found = []
    for number in numbers:
        own = rows if number is None else rows[rows[instance] == number]
        own_times = times if number is None else times[rows[instance] == number]
        columns = {
            name: _cells(own[name], scales[name])
            for name in form.columns
            if name not in (stamps.column, instance)
        }
        shown = number.decode("utf-8", "replace") if isinstance(number, bytes) else number
        name = f"/{form.name}" if number is None else f"/{form.name}_{shown}"
        stated = {field: unit for field, unit in units.items() if field in columns}
        stated = {field: unit for field, unit in stated.items() if unit not in ("", "UNKNOWN")}
        topic = Topic(name, form.name, leaves_of(columns), units=stated)

        def load(loaded: tuple[Any, Columns] = (own_times, columns)) -> tuple[Any, Columns]:
            return loaded

        found.append(ColumnTopic(topic, len(own), load))
    return found


def _stamps_of(form: Any) -> Stamps | None:
    """The stamp field of a message format; `None` if it has none."""
    known = _STAMPS if form.name.startswith("GPS") else _STAMPS[1:]
    return next((stamps for stamps in known if stamps.column in form.columns), None)


def _cells(column: Any, scale: float | None) -> Any:
    """The values of a raw column: texts without padding, numbers scaled."""
    if column.dtype.kind == "S":
        texts = [one.partition(b"\0")[0].decode("utf-8", "replace") for one in column.tolist()]
        return np.array(texts, object)
    if scale is None:
        return column
    # The double nearest to 337.09 is 33709 / 100, and not 33709 * 0.01.
    wide = column.astype(np.float64)
    return wide / (1 / scale) if 0 < scale < 1 else wide * scale


def _damage(log: Any, data: Any, starts: Mapping[int, Any], end: int) -> list[Outage]:
    """The outages at bytes that belong to no message, in order."""
    places = np.concatenate([*starts.values()])
    lengths = np.concatenate(
        [np.full(len(own), log.formats[number].len) for number, own in starts.items()]
    )
    order = np.argsort(places, kind="stable")
    places, lengths = places[order], lengths[order]
    ends = places + lengths
    times = np.full(len(places), -1, np.int64)
    for number, own in starts.items():
        form = log.formats[number]
        stamps = _stamps_of(form)
        if stamps is not None and len(own):
            inside = own[own + form.len <= len(data)]
            stamped = _rows(form, data, inside)[stamps.column]
            times[np.searchsorted(places, inside)] = ticks_of_column(stamped, stamps)
    found = []
    # In an undamaged log each message starts where the one before ends.
    for gap in np.flatnonzero(ends[:-1] != places[1:]).tolist():
        before, after = times[: gap + 1], times[gap + 1 :]
        since = int(before.max())  # a lost message may have had the stamp of the one before
        known = after[after >= 0]
        until = int(known[0]) if len(known) else max(end, since)
        why = f"there is no message at byte {int(ends[gap]):,}"
        found.append(Outage(since, max(since, until), why))
    rest = data[int(ends[-1]) :] if len(ends) else data
    is_filling = len(rest) < _PAGE and bool((rest == 0).all() or (rest == _ERASED).all())
    if len(places) and (ends[-1] > len(data) or not is_filling):
        found.append(Outage(end, end + 1, "it ends within a message"))
    return sorted(found, key=lambda outage: outage.since)
