"""Plain JSON lines as columns, a block of the file at a time: memory does not grow with the file.

The first line says what the others look like; where one does not, all is read line by line.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from rvmon.readers.batch import NotPlainError
from rvmon.readers.blocks import Block
from rvmon.readers.jsonl_batch import instants_of, line_struct
from rvmon.readers.line_chunks import BLOCK, whole_lines
from rvmon.readers.naming import DEFAULT_COLUMNS
from rvmon.readers.plain import held_values
from rvmon.trace.schema import Kind, Schema
from rvmon.trace.stamps import stamps_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_Given = msgspec.UnsetType
_TYPES: Mapping[Kind, Any] = {
    Kind.BOOL: bool | int | _Given,
    Kind.INT: int | float | _Given,
    Kind.REAL: int | float | _Given,
}
_ANYTHING: Any = bool | int | float | str | list[Any] | None | _Given
"""What an undeclared name may hold; objects may hold declared names."""

_FITTING = {Kind.INT: "i", Kind.REAL: "fi"}


@dataclass(slots=True)
class _Shape:
    """What the lines of a file look like.

    Attributes:
        stamp: `t` or `t_ns`.
        places: by declared name, where its value is in a decoded line.
        ignored: the same of names that are not declared, in the order of the line.
    """

    stamp: str
    places: dict[str, str] = field(default_factory=dict)
    ignored: dict[str, str] = field(default_factory=dict)


def jsonl_blocks(
    path: str | Path, schema: Schema, fillable: frozenset[str], ignored: Counter[str]
) -> Iterator[Block]:
    """Read a plain file of JSON lines.

    Plain is: objects of numbers and truth values with the names of the first line, be they nested;
    no null, labels, payloads or lists of events; instants that increase; names as declared.

    Args:
        path: of the file.
        schema: the declared names; there is a column for each.
        fillable: the names of which "no update" may be read as what was there before: of signals
            the value, of events that they do not occur.
        ignored: names that are not declared are counted here, from 0.

    Raises:
        NotPlainError: it is not; the blocks before were right.
    """
    ignored.clear()
    if schema.stamps is not None or schema.columns:
        raise NotPlainError("stamps or names have another form")
    decoder = shape = None
    last = None
    held: dict[str, Any] = {}
    for text in whole_lines(path, BLOCK):
        if shape is None:
            decoder, shape = _shape_of(text.partition(b"\n")[0], schema)
        rows = _decoded(text, decoder)
        times = instants_of([row.stamp for row in rows], stamps_of(shape.stamp))
        if not (times[1:] > times[:-1]).all() or (last is not None and times[0] <= last):
            raise NotPlainError("its instants do not increase")
        last = times[-1]
        columns: dict[str, NDArray[Any]] = {}
        for name, kind in schema.signals.items():
            cells = _cells(rows, shape.places.get(name))
            columns[name] = _values(cells, kind, held.get(name), gaps=name in fillable)
            held[name] = columns[name][-1]
        for name in schema.events:
            cells = _cells(rows, shape.places.get(name))
            columns[name] = _occurrences(cells, len(rows), gaps=name in fillable)
        for name, place in shape.ignored.items():
            ignored[name] += sum(cell is not msgspec.UNSET for cell in _cells(rows, place) or ())
        yield Block(times, columns)
    if last is None:
        raise NotPlainError("it has no rows")


def _decoded(text: bytes, decoder: Any) -> list[Any]:
    """The lines of a text, each of which holds one object."""
    lines = text.count(b"\n")
    if text.count(b"\n{") + 1 != lines or text.count(b"}\n") != lines or text[:1] != b"{":
        raise NotPlainError("its lines are not all alike")
    try:
        rows: list[Any] = decoder.decode_lines(text)
    except (msgspec.DecodeError, RecursionError):
        raise NotPlainError("a line is no object of JSON") from None
    if len(rows) != lines:
        raise NotPlainError("its lines are not all alike")
    return rows


def _shape_of(line: bytes, schema: Schema) -> tuple[Any, _Shape]:
    """What decodes lines that look like this one."""
    try:
        first = msgspec.json.decode(line)
    except (msgspec.DecodeError, RecursionError):
        raise NotPlainError("its first line is no object of JSON") from None
    stamps = [name for name in DEFAULT_COLUMNS if isinstance(first, dict) and name in first]
    if len(stamps) != 1 or ("events" in first and "events" not in schema.signals):
        raise NotPlainError("its first line has not one stamp")
    shape = _Shape(stamps[0])
    del first[stamps[0]]
    fields, names = _fields(first, "", "", schema, shape)
    fields.insert(0, ("stamp", int | float))
    names["stamp"] = stamps[0]
    return msgspec.json.Decoder(line_struct(fields, names)), shape


def _fields(
    found: Mapping[str, Any], prefix: str, place: str, schema: Schema, shape: _Shape
) -> tuple[list[Any], dict[str, str]]:
    """The fields of an object: name, type, default; and the keys that they stand for."""
    fields: list[Any] = []
    names = {}
    for number, (key, value) in enumerate(found.items()):
        own, name = f"f{number}", prefix + key
        names[own] = key
        if name in shape.places or name in shape.ignored:  # `a.b` beside `b` in `a`
            raise NotPlainError("two keys stand for one name")
        type_: Any = _ANYTHING
        if name in schema.signals:
            kind = schema.signals[name]
            if kind not in _TYPES:
                raise NotPlainError("a signal holds labels")
            type_ = _TYPES[kind]
            shape.places[name] = place + own
        elif name in schema.events:
            type_ = bool | _Given
            shape.places[name] = place + own
        elif isinstance(value, dict):
            inside = _fields(value, f"{name}.", f"{place}{own}.", schema, shape)
            object_ = line_struct(*inside)
            fields.append((own, object_, msgspec.field(default_factory=object_)))
            continue
        else:
            shape.ignored[name] = place + own
        fields.append((own, type_, msgspec.UNSET))
    return fields, names


def _cells(rows: Sequence[Any], place: str | None) -> list[Any] | None:
    return None if place is None else list(map(attrgetter(place), rows))


def _values(cells: list[Any] | None, kind: Kind, before: Any, *, gaps: bool) -> NDArray[Any]:
    """The values of a signal; gaps are filled with what it holds."""
    if cells is None:
        raise NotPlainError("a signal is not in its first line")
    some = [cell for cell in cells if cell is not msgspec.UNSET]
    values = _truths(some) if kind is Kind.BOOL else _numbers(some, kind)
    if len(some) == len(cells):
        return values
    if not gaps:
        raise NotPlainError("a signal has gaps that may matter")
    given = np.array([cell is not msgspec.UNSET for cell in cells])
    return held_values(values, given, before)


def _truths(cells: list[Any]) -> NDArray[np.bool_]:
    try:
        found = np.frombuffer(bytes(cells), np.uint8)
    except ValueError:  # a number that is no byte
        raise NotPlainError("a truth value is something else") from None
    if len(found) and found.max() > 1:
        raise NotPlainError("a truth value is something else")
    return found.view(np.bool_)


def _numbers(cells: list[Any], kind: Kind) -> NDArray[Any]:
    if not cells:
        return np.empty(0, np.int64 if kind is Kind.INT else np.float64)
    found = np.array(cells)
    if found.dtype.kind not in _FITTING[kind]:
        raise NotPlainError("a number is something else")
    return found if kind is Kind.INT else found.astype(np.float64, copy=False)


def _occurrences(cells: list[Any] | None, count: int, *, gaps: bool) -> NDArray[np.bool_]:
    """Where an event occurs; where nothing is known of it, it does not."""
    if cells is None:
        cells = [msgspec.UNSET] * count
    if msgspec.UNSET in cells and not gaps:
        raise NotPlainError("an event has gaps that may matter")
    return np.array([cell is True for cell in cells], bool)
