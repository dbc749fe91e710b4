"""Reader of CAN logs, decoded by databases; needs python-can and cantools, the extra `can`."""

from __future__ import annotations

import logging
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from rvmon.errors import TraceError, needed
from rvmon.recordings import DATABASES, frame_databases
from rvmon.recordings.messages import Message, Messages, Topic, errors_as_damage
from rvmon.recordings.messages.column_topics import path_of
from rvmon.recordings.values import first_line
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Kind
from rvmon.trace.time import ticks_of_seconds

_Key = tuple[int, bool]
_UNREAD = "there is a line that cannot be read"
_DROPPED = "the recorder reports that frames were lost"
_NEVER, _ALWAYS = re.compile("(?!)"), re.compile("")
_ERROR = r"\(\S+\)\s+\S+\s+[23]"
"""The start of an error frame in candump's format, up to the first digit of its identifier."""

_TEXTS = {
    ".asc": (
        re.compile(
            r"\s*($|//|(date|base|internal|no|previous|begin|end)\b|"
            r"\d+\.\d+\s+((?!canfd)[a-z]|\d+\s+(?!errorframe|[rt]x\b)[a-z]*[g-z]))",
            re.IGNORECASE,
        ),
        _NEVER,
        _NEVER,
    ),
    ".trc": (
        re.compile(r"\s*($|;)|.*\b(Warng|Error|ST|EC|ER|EV|FFFFFFFF)\b"),
        re.compile(r".*\b(FFFFFFFF|ST)\b.* 00 00 00 ([4-7C-F][\dA-F]|[\dA-F][2367ABEF])\b"),
        _NEVER,
    ),
    ".log": (
        _ALWAYS,
        re.compile(rf"DROPCOUNT|{_ERROR}[\dA-F]{{6}}[4-7C-F]#[\dA-F]{{3}}[13579BDF]"),
        re.compile(rf"DROPCOUNT|{_ERROR}[\dA-F]{{7}}#"),
    ),
}
"""Three patterns of lines per text format. The first: known lines without a frame; the library
skips these, but also any line that it cannot read. The second: lines that report lost frames after
an overflow (CAN_ERR_CRTL_RX_OVERFLOW; OVERRUN and QOVERRUN of PCAN). The third: lines that must be
hidden from the library, as it would take them for frames or fail."""

_LOST = {125: True, 126: False}
"""By the type of a BLF object: whether frames are lost from there on, or were lost up to there."""

_PDU_2 = 240  # from this PDU format on, the second byte of a J1939 identifier is no address


class FrameMessages(Messages):
    """An open CAN log; opening it reads it once to find its topics.

    Databases are the texts in `definitions` (by file name), or else the files beside the log. Each
    database message in the log is a topic. The name of the topic includes the channel if the
    message was seen on several channels, and the identifier if another message has the same name.
    """

    def __init__(self, path: Path, definitions: Mapping[str, str]) -> None:
        self._path = path
        self._is_cut = _is_cut(path)
        self._known = _messages(path, definitions)
        self._seen: dict[_Key, Any] = {}
        # where lines cannot be read or frames were lost, and the end if the log was cut off
        self.outages: list[Outage] = []
        self._called = _names(self._known.values())
        channels: dict[str, set[Any]] = {}
        by_name: dict[str, Any] = {}
        others = 0
        for t, key, channel, _ in self._frames(self.outages):
            self.end = t if self.end is None else max(self.end, t)
            message = self._message(key)
            if message is None:
                others += 1
            else:
                name = self._called[id(message)]
                by_name[name] = message
                channels.setdefault(name, set()).add(channel)
                self.count += 1
        if not self.count:
            raise TraceError(
                f"none of its {others:,} frames is in the databases: name the right one in a "
                'binding, as `definitions = ["car.dbc"]`'
            )
        self._several = {name for name, found in channels.items() if len(found) > 1}
        self.topics = {
            (topic := self._name(name, channel)): _topic(topic, by_name[name])
            for name, found in channels.items()
            for channel in sorted(found, key=str)
        }
        if self.end is not None:
            self.end = max([self.end, *(outage.until for outage in self.outages)])
            if self._is_cut:
                self.outages.append(Outage(self.end, self.end + 1, "it was cut off, or not closed"))
                self.end += 1

    def _name(self, message: str, channel: Any) -> str:
        if message not in self._several:
            return f"/{message}"
        return f"/can{channel}/{message}" if str(channel).isdigit() else f"/{channel}/{message}"

    def _message(self, key: _Key) -> Any:
        if key not in self._seen:
            found = self._known.get(key)
            self._seen[key] = self._known.get(_group(key)) if found is None and key[1] else found
        return self._seen[key]

    def _frames(
        self, outages: list[Outage] | None = None
    ) -> Iterator[tuple[int, _Key, Any, bytes]]:
        """Yield ticks, identifier, channel and data of each data frame; add losses to `outages`."""
        ending = self._path.suffix.lower()
        if ending == ".mf4":
            from rvmon.recordings.messages.mdf import mdf_frames

            yield from mdf_frames(self._path)
            return
        held, last = None, None  # `held`: the latest frame, which may be cut off
        mode: dict[str, Any] = {"mode": "rb"} if ending == ".blf" else {"errors": "replace"}
        with open(self._path, **mode) as file, errors_as_damage("a log of CAN"):
            frames, losing = _reading(self._path, file)
            for frame in frames:
                t = ticks_of_seconds(frame.timestamp)
                if (why := losing.take()) and outages is not None:
                    # A lost frame may have had the stamp of the frame before it.
                    outages.append(Outage(t - 1 if last is None else min(last, t), t, why))
                last = t
                if frame.is_error_frame or frame.is_remote_frame:
                    continue
                if held is not None:
                    yield held
                key = (frame.arbitration_id, frame.is_extended_id)
                held = t, key, frame.channel, bytes(frame.data)
            if losing.why and outages is not None and last is not None:
                outages.append(Outage(last, last + 1, losing.why))
        if held is not None and not (self._is_cut and ending != ".blf"):
            yield held  # the last frame, unless its line may have been cut off

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the frames of these topics, decoded, in the order of the log."""
        readers: dict[int, Callable[[bytes], Mapping[str, Any]]] = {}
        for t, key, channel, data in self._frames():
            message = self._message(key)
            which = id(message)
            if message is None or (name := self._name(self._called[which], channel)) not in topics:
                continue
            if which not in readers:
                readers[which] = _reader(message)
            try:
                yield name, t, readers[which](data)
            except Exception as error:  # noqa: BLE001 - the library has its own exceptions
                raise TraceError(
                    f"a frame of {name} at {t} ns does not fit the database ({first_line(error)})"
                ) from None


class _Lines:
    """The lines of a text log as the library reads them, watched for losses between frames."""

    def __init__(self, file: Any, patterns: tuple[re.Pattern[str], ...]) -> None:
        self._file = file
        self._others, self._lost, self._hidden = patterns
        self._line = ""
        self.why = ""  # the cause of a loss since the last frame; "": nothing was lost

    def __iter__(self) -> _Lines:
        return self

    def __next__(self) -> str:
        while True:
            if self._lost.match(self._line):
                self.why = _DROPPED
            elif not self._others.match(self._line):
                self.why = _UNREAD
            self._line = next(self._file, "")
            if not self._line:
                raise StopIteration
            if "\0" in self._line:  # a block that was never written joins several lines to one
                self.why = _UNREAD
            if not self._hidden.match(self._line):
                return self._line

    def take(self) -> str:
        """The cause of a loss before the line read last, which is a frame; "": nothing was lost."""
        found, self.why, self._line = self.why, "", ""
        return found

    def close(self) -> None:
        """Do nothing: the library calls this, but the file is closed where it was opened."""


def _is_cut(path: Path) -> bool:
    """Whether a log was cut off: a text ends within a line, or BLF has not its stated size."""
    ending = path.suffix.lower()
    with open(path, "rb") as file:
        size = file.seek(0, 2)
        if ending == ".blf":
            file.seek(16)
            return int.from_bytes(file.read(8), "little") != size
        file.seek(max(0, size - 1))
        return bool(ending != ".mf4" and file.read() not in (b"\n", b"\r", b""))


def _reading(path: Path, file: Any) -> tuple[Iterable[Any], Any]:
    """The frames of an open log, and the object that tells losses between them, like `_Lines`."""
    with needed("a log of CAN", "python-can"):
        from can import ASCReader, BLFReader, CanutilsLogReader, TRCReader
    logging.getLogger("can").setLevel(logging.CRITICAL)

    class Objects(BLFReader):
        """A BLF reader that notes objects about lost frames, which the library skips."""

        why, is_losing = "", False

        def _parse_data(self, data: bytes) -> Iterator[Any]:
            lost = [
                (found.start(), _LOST[kind])
                for found in re.finditer(rb"LOBJ.{8}(....)", data, re.DOTALL)
                if (kind := int.from_bytes(found[1], "little")) in _LOST
            ]

            def come_to(place: int) -> None:
                while lost and lost[0][0] <= place:
                    self.is_losing = lost.pop(0)[1]
                    self.why = _DROPPED

            for frame in super()._parse_data(data):
                come_to(self._pos)
                yield frame
            come_to(self._pos - 1)

        def take(self) -> str:
            found, self.why = self.why, _DROPPED if self.is_losing else ""
            return found

    ending = path.suffix.lower()
    if ending == ".blf":
        objects = Objects(file)
        return objects, objects
    lines = _Lines(file, _TEXTS[ending])
    readers = {".asc": ASCReader, ".log": CanutilsLogReader, ".trc": TRCReader}
    return readers[ending](lines), lines


def _messages(path: Path, definitions: Mapping[str, str]) -> Mapping[_Key, Any]:
    """The messages of all databases by identifier; those of J1939 by their group as well.

    Raises:
        TraceError: there is no database, or one cannot be read.
        RvmonError: cantools is not installed.
    """
    with needed("a database of CAN", "cantools"):
        from cantools import database
    logging.getLogger("cantools").setLevel(logging.CRITICAL)
    texts = {name: text for name, text in definitions.items() if name.lower().endswith(DATABASES)}
    files = frame_databases(path)
    if not texts and not files:
        raise TraceError(
            "is read as a CAN log, but nothing describes its signals: put the database (.dbc) "
            'beside it, or name it in a binding, as `definitions = ["car.dbc"]`'
        )
    found: dict[_Key, Any] = {}
    for name in texts or files:
        try:
            if texts:
                form = name.rpartition(".")[2].lower()
                loaded = database.load_string(texts[name], database_format=form, strict=False)
            else:
                loaded = database.load_file(name, strict=False)
        except Exception as error:  # noqa: BLE001 - each form of database has its own exceptions
            raise TraceError(
                f"{name} cannot be read as a database of CAN ({first_line(error)})"
            ) from None
        for message in getattr(loaded, "messages", ()):
            key = (message.frame_id, message.is_extended_frame)
            found.setdefault(key, message)
            if message.protocol == "j1939" and message.is_extended_frame:
                found.setdefault(_group(key), message)
    return found


def _names(messages: Iterable[Any]) -> Mapping[int, str]:
    """The names of messages by object id, with the identifier where two have the same name."""
    known = {id(message): message for message in messages}
    counts = Counter(message.name for message in known.values())
    digits = {
        which: f"{message.frame_id:0{8 if message.is_extended_frame else 3}X}"
        for which, message in known.items()
    }
    return {
        which: message.name if counts[message.name] == 1 else f"{message.name}_{digits[which]}"
        for which, message in known.items()
    }


def _group(key: _Key) -> _Key:
    """The parameter group of a J1939 identifier, as a negative key that no identifier equals."""
    form, specific = key[0] >> 16 & 0xFF, key[0] >> 8 & 0xFF
    page = key[0] >> 24 & 3
    return -(page << 16 | form << 8 | (specific if form >= _PDU_2 else 0)) - 1, True


def _topic(name: str, message: Any) -> Topic:
    leaves = {path_of(signal.name): _kind(signal) for signal in message.signals}
    units = {path_of(signal.name): signal.unit for signal in message.signals if signal.unit}
    return Topic(name, message.name, leaves, units=units)


def _is_named(signal: Any) -> bool:
    """Whether a signal is an enumeration: its named values are states, not special numbers."""
    if not signal.choices or len(signal.choices) < 2 or signal.unit:
        return False
    return bool(signal.conversion.scale == 1 and signal.conversion.offset == 0)


def _kind(signal: Any) -> Kind:
    if _is_named(signal):
        return Kind.LABEL
    scale, offset = signal.conversion.scale, signal.conversion.offset
    if signal.conversion.is_float or scale != int(scale) or offset != int(offset):
        return Kind.REAL
    return Kind.BOOL if signal.length == 1 else Kind.INT


def _reader(message: Any) -> Callable[[bytes], Mapping[str, Any]]:
    """A decoder of frames; a number with a name, such as "not available", is unknown."""
    named = {signal.name: signal.choices for signal in message.signals if _is_named(signal)}
    special = {
        signal.name: {
            signal.conversion.raw_to_scaled(raw, decode_choices=False) for raw in signal.choices
        }
        for signal in message.signals
        if signal.choices and signal.name not in named
    }
    bits = {signal.name for signal in message.signals if _kind(signal) is Kind.BOOL}

    def value(name: str, number: Any) -> Any:
        if name in named:
            return str(named[name].get(number, number))
        if name in special and number in special[name]:
            return None
        return bool(number) if name in bits else number

    def read(data: bytes) -> Mapping[str, Any]:
        decoded = message.decode(data, decode_choices=False, allow_truncated=False)
        return {path_of(name): value(name, number) for name, number in decoded.items()}

    return read
