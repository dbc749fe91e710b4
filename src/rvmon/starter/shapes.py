"""The kinds of values in a recording, from its text alone."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from io import TextIOWrapper
from typing import Any

import msgspec

from rvmon.errors import TraceError
from rvmon.readers.csv_rows import split_lines
from rvmon.readers.line_chunks import bounded_lines
from rvmon.readers.naming import DEFAULT_COLUMNS
from rvmon.readers.places import opened
from rvmon.readers.recording import format_of
from rvmon.readers.values import FALSE_WORDS, TRUE_WORDS
from rvmon.starter.column import Shape, Shapes
from rvmon.trace.schema import Kind, Stamps

MOST_LABELS = 16
"""A text column with more values than this is left out."""

RARE = 0.2
"""A JSON object under a key of fewer lines than this share is taken for the payload of an event."""

_NUMBER = re.compile(
    r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE
)
_WHOLE = re.compile(r"[+-]?\d{1,18}", re.ASCII)


class Seen:
    """What was seen under one name; a CSV cell 0 or 1 is a bit: number or truth value."""

    def __init__(self) -> None:
        self.kinds: set[Kind] = set()
        self.bits = False
        self.labels: dict[str, None] = {}
        self.fields: dict[str, Seen] = {}
        self.payloads = 0
        self.count = 0
        self.other = False

    def add(self, value: object) -> None:
        """Take a JSON value that is neither null nor an object."""
        self.count += 1
        match value:
            case bool():
                self.kinds.add(Kind.BOOL)
            case int():
                self.kinds.add(Kind.INT)
            case float():
                self.kinds.add(Kind.REAL)
            case str():
                self.kinds.add(Kind.LABEL)
                self._label(value)
            case _:
                self.other = True

    def add_text(self, cell: str) -> None:
        """Take a CSV cell that is not empty."""
        self.count += 1
        if cell in TRUE_WORDS or cell in FALSE_WORDS:
            if cell in "01":
                self.bits = True
            else:
                self.kinds.add(Kind.BOOL)
        elif _WHOLE.fullmatch(cell):
            self.kinds.add(Kind.INT)
        elif _NUMBER.fullmatch(cell):
            self.kinds.add(Kind.REAL)
        else:
            self.kinds.add(Kind.LABEL)
        self._label(cell)

    def _label(self, text: str) -> None:
        if len(self.labels) <= MOST_LABELS:
            self.labels[text] = None

    def add_payload(self, payload: Mapping[str, object]) -> None:
        """Take an object."""
        self.count += 1
        self.payloads += 1
        for key, value in payload.items():
            if value is not None:
                self.fields.setdefault(key, Seen()).add(value)


def shapes_of(path: str, stamps: Stamps | None = None) -> Shapes:
    """Look at the names and values of a CSV or JSON-lines file, packed or not.

    Args:
        path: of the file.
        stamps: where it says when; default `t` or `t_ns`.

    Raises:
        TraceError: the file cannot be read, or has no time column.
    """
    form = format_of(path)
    try:
        with opened(path) as (plain, _), TextIOWrapper(plain, "utf-8-sig", newline="") as text:
            look = _of_csv if form == "csv" else _of_json
            return look(bounded_lines(text), path, stamps)
    except OSError as error:
        raise TraceError(f"{path}: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise TraceError(f"{path}: not UTF-8 text: is this a binary file?") from None
    except TraceError as error:
        message = str(error)
        raise TraceError(message if path in message else f"{path}: {message}") from None


def _of_csv(text: Iterable[str], path: str, stamps: Stamps | None) -> Shapes:
    rows = split_lines(text)
    try:
        _, header = next(rows)
    except StopIteration:
        raise TraceError("is empty: expected a header with a time column `t`") from None
    if stamps is None:
        _require_time(header, path)
    columns = [Seen() for _ in header]
    for _, row in rows:
        for seen, cell in zip(columns, row, strict=False):
            if cell:
                seen.add_text(cell)
    return _shapes(_without_time(dict(zip(header, columns, strict=True)), stamps))


def _without_time(seen: Mapping[str, Seen], stamps: Stamps | None) -> dict[str, Seen]:
    times = DEFAULT_COLUMNS if stamps is None else (stamps.column,)
    return {name: entry for name, entry in seen.items() if name not in times}


def _require_time(names: Iterable[str], path: str) -> None:
    known = list(names)
    if not set(DEFAULT_COLUMNS).intersection(known):
        close = [name for name in known if re.search(r"time|stamp|^sec", name, re.IGNORECASE)]
        which = f"`{close[0]}` looks like it" if close else f"found {', '.join(known[:6])}"
        raise TraceError(
            f"{path}: no time column: {which}; rename the time column to `t` (seconds) or `t_ns` "
            "(integer nanoseconds), or name it with --time COLUMN[:UNIT]"
        )


def _of_json(lines: Iterable[str], path: str, stamps: Stamps | None) -> Shapes:
    decode = msgspec.json.Decoder().decode
    seen: dict[str, Seen] = {}
    events: dict[str, Seen] = {}
    count = 0
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            fields = decode(line)
        except (msgspec.DecodeError, RecursionError) as error:
            raise TraceError(f"line {number}: not a JSON object ({error})") from None
        if not isinstance(fields, dict):
            raise TraceError(f'line {number}: expected an object such as {{"t": 0.5, "x": 1}}')
        if not count and stamps is None:
            _require_time(fields, f"{path}: line {number}")
        count += 1
        listed = fields.get("events")
        if isinstance(listed, list) and all(isinstance(name, str) for name in listed):
            del fields["events"]
            for name in listed:
                events.setdefault(name, Seen()).add_payload({})
        _collect(fields, "", seen)
    return _shapes({**_without_time(_without_rare_objects(seen, count), stamps), **events})


def _collect(fields: Mapping[str, Any], prefix: str, seen: dict[str, Seen]) -> None:
    for key, value in fields.items():
        name = prefix + key
        if value is None:
            continue
        entry = seen.setdefault(name, Seen())
        if isinstance(value, dict):
            entry.add_payload(value)
            _collect(value, name + ".", seen)
        elif isinstance(value, list) and value and all(isinstance(v, dict) for v in value):
            for payload in value:
                entry.add_payload(payload)
        else:
            entry.add(value)


def _without_rare_objects(seen: Mapping[str, Seen], lines: int) -> dict[str, Seen]:
    """The names to declare: of an object either its parts, or, if it is rare, itself alone."""
    kept: dict[str, Seen] = {}
    for name, entry in seen.items():
        inside = any(name.startswith(event + ".") for event in kept if kept[event].payloads)
        if inside:
            continue
        parts = any(other.startswith(name + ".") for other in seen)
        if entry.payloads and parts and entry.payloads >= RARE * lines:
            continue
        kept[name] = entry
    return kept


def _shapes(seen: Mapping[str, Seen]) -> Shapes:
    declared: dict[str, Shape] = {}
    left_out: dict[str, str] = {}
    for name, entry in seen.items():
        shape = _shape(entry)
        if "`" in name or not name.strip() or not name.isprintable():
            left_out[name] = "its name cannot be written"
        elif isinstance(shape, str):
            left_out[name] = shape
        else:
            declared[name] = shape
    return Shapes(declared, left_out)


def _shape(seen: Seen) -> Shape | str:
    """The shape, or why there is none."""
    if seen.payloads:
        if seen.kinds - {Kind.BOOL} or seen.other:
            return "objects and other values"
        kinds = {name: _shape(entry) for name, entry in seen.fields.items()}
        return Shape(
            None,
            fields={
                name: shape.kind
                for name, shape in kinds.items()
                if isinstance(shape, Shape) and shape.kind not in (None, Kind.LABEL)
                if name.isidentifier()
            },
        )
    if seen.other:
        return "lists"
    if not seen.kinds:
        return Shape(Kind.BOOL) if seen.bits else "no value in the recording"
    if seen.kinds == {Kind.BOOL}:
        return Shape(Kind.BOOL)
    if seen.kinds <= {Kind.INT, Kind.REAL}:
        return Shape(Kind.REAL if Kind.REAL in seen.kinds else Kind.INT)
    if seen.kinds != {Kind.LABEL} or seen.bits:
        return "numbers and text"
    if len(seen.labels) > MOST_LABELS:
        return f"text with more than {MOST_LABELS} values"
    if any("`" in label or not label.strip() or not label.isprintable() for label in seen.labels):
        return "text that cannot be written as labels"
    return Shape(Kind.LABEL, labels=tuple(seen.labels))
