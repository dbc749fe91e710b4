"""JSON lines in pieces: rows as columns where a piece is plain, else one by one.

The first lines of a piece say what the others look like; where one does not, that is read line by
line.
"""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, repeat
from operator import attrgetter, is_not
from typing import TYPE_CHECKING, Any, BinaryIO

import msgspec
import numpy as np

from rvmon.errors import TraceError
from rvmon.readers import line_chunks
from rvmon.readers.batch import NO, YES, Batch, NotPlainError, Occurrences
from rvmon.readers.cells import cells_of_values
from rvmon.readers.jsonl_rows import count_of_names, jsonl_samples, names_in
from rvmon.readers.line_chunks import bounded_lines, whole_pieces
from rvmon.readers.naming import DEFAULT_COLUMNS
from rvmon.readers.rows import Row
from rvmon.readers.table_batch import ticks_of_column
from rvmon.trace.ignored import bound
from rvmon.trace.schema import Kind, Schema, Stamps
from rvmon.trace.stamps import stamps_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_Given = msgspec.UnsetType
_SCALAR: Any = bool | int | float | str | None | _Given
_ANYTHING: Any = bool | int | float | str | list[Any] | None | _Given
"""What an undeclared name may hold; objects may hold declared names."""
_EVENT: Any = bool | dict[str, bool | int | float | str | None] | None | _Given

_WITH_NAMES = {dict, list}

_LOOKED_AT = 50
"""So many lines of a piece say what its lines look like."""

_MARK = b"\xef\xbb\xbf"


@dataclass(slots=True)
class _Shape:
    """What the lines of a piece look like.

    Attributes:
        decode: reads a text of them.
        stamps: says their unit.
        places: by declared name, where its value is in a decoded line.
        ignored: the same of names that are not declared, in the order of the line.
        objects: of each object in a line, where the values in it are.
    """

    stamps: Stamps
    decode: Callable[[bytes], list[Any]] = list
    places: dict[str, str] = field(default_factory=dict)
    ignored: dict[str, str] = field(default_factory=dict)
    objects: list[list[str]] = field(default_factory=list)


def jsonl_batches(
    file: BinaryIO, schema: Schema, ignored: Counter[str], found_stamps: Callable[[Stamps], None]
) -> Iterator[Batch | Iterator[Row]]:
    """The rows of a text, in order.

    Args:
        file: is read from its start.
        schema: the declared names.
        ignored: names that are not declared are counted here.
        found_stamps: told what the stamps of the first line are.

    Raises:
        TraceError: with the line's number.
    """
    line = 0
    for text in whole_pieces(file, line_chunks.BLOCK):
        if not line and schema.stamps is None:
            first = text.partition(b"\n")[0]
            found_stamps(stamps_of("t_ns" if b'"t_ns"' in first else "t"))
        try:
            batch = _batch(text.removeprefix(b"" if line else _MARK), schema, ignored)
        except NotPlainError:
            yield _numbered(jsonl_samples(_lines(text), schema, ignored), line)
        else:
            yield replace(batch, first=line + 1)
        line += text.count(b"\n")


def _lines(text: bytes) -> Iterator[str]:
    return bounded_lines(io.StringIO(text.decode(), newline=""))


def _numbered(rows: Iterator[Row], before: int) -> Iterator[Row]:
    """The rows with the numbers of their lines, of which so many stand before."""
    try:
        for number, t, values in rows:
            yield number + before, t, values
    except TraceError as error:
        head, _, rest = str(error).partition(":")
        line = head.removeprefix("line ")
        if not line.isdecimal():
            raise
        raise type(error)(f"line {int(line) + before}:{rest}") from None


def _batch(text: bytes, schema: Schema, ignored: Counter[str]) -> Batch:
    """A piece as columns.

    Raises:
        NotPlainError: a line is something else than those above it.
    """
    lines = text.count(b"\n") + (not text.endswith(b"\n"))
    if schema.stamps is not None or schema.columns or b"\r" in text:
        raise NotPlainError("stamps or names have another form")
    shape = _shape_of(text, schema)
    try:
        rows = shape.decode(text)
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        raise NotPlainError("a line is none of those objects") from None
    if len(rows) != lines:
        raise NotPlainError("its lines are not all alike")
    if names_in(text) != _names_given(rows, shape):
        raise NotPlainError("a name may stand twice in a line")
    batch = Batch(
        instants_of([row.stamp for row in rows], shape.stamps),
        {
            name: cells_of_values(
                _cells(rows, shape.places[name]), kind, schema.gaps, msgspec.UNSET
            )
            for name, kind in schema.signals.items()
            if name in shape.places
        },
        {
            name: _occurrences(rows, shape.places[name], fields, schema)
            for name, fields in schema.events.items()
            if name in shape.places
        },
    )
    for name, place in shape.ignored.items():
        count = sum(cell is not msgspec.UNSET for cell in map(attrgetter(place), rows))
        if count:
            ignored[name] += count
    bound(ignored)
    return batch


def _names_given(rows: Sequence[Any], shape: _Shape) -> int:
    """How many names the lines have, each of those that objects have once."""
    given = {"stamp": len(rows)}
    inside = 0
    for place in (*shape.places.values(), *shape.ignored.values()):
        cells = _cells(rows, place)
        given[place] = sum(map(is_not, cells, repeat(msgspec.UNSET)))
        if not _WITH_NAMES.isdisjoint(map(type, cells)):
            inside += sum(map(count_of_names, cells))
    objects = sum(
        len(rows)
        if max((given[place] for place in leaves), default=0) == len(rows)
        else _with_any(rows, leaves)
        for leaves in shape.objects
    )
    return sum(given.values()) + inside + objects


def _with_any(rows: Sequence[Any], places: Sequence[str]) -> int:
    """How many rows have a value in one of these places."""
    cells = zip(*(_cells(rows, place) for place in places), strict=True)
    return sum(any(one is not msgspec.UNSET for one in row) for row in cells)


def _shape_of(text: bytes, schema: Schema) -> _Shape:
    """What decodes lines that look like the first ones."""
    try:
        looked_at = [
            msgspec.json.decode(line)
            for line in islice(text.split(b"\n", _LOOKED_AT), _LOOKED_AT)
            if line
        ]
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        raise NotPlainError("a line is no object of JSON") from None
    whole: dict[str, Any] = {}
    for one in looked_at:
        if not isinstance(one, dict):
            raise NotPlainError("a line is no object of JSON")
        _join(whole, one, schema)
    stamps = [name for name in DEFAULT_COLUMNS if name in whole]
    if len(stamps) != 1 or ("events" in whole and "events" not in schema.signals):
        raise NotPlainError("its lines have not one stamp")
    del whole[stamps[0]]
    shape = _Shape(stamps_of(stamps[0]))
    fields, names = _fields(whole, "", "", schema, shape)
    fields.insert(0, ("stamp", int | float))
    names["stamp"] = stamps[0]
    shape.decode = msgspec.json.Decoder(line_struct(fields, names)).decode_lines
    return shape


def _join(whole: dict[str, Any], more: Mapping[str, Any], schema: Schema, prefix: str = "") -> None:
    """Add the names of an object, and of those in it, to what is known of others."""
    for key, value in more.items():
        name = prefix + key
        is_declared = name in schema.signals or name in schema.events
        if isinstance(value, dict) and not is_declared:
            inside = whole.setdefault(key, {})
            if inside is None:
                raise NotPlainError("a name is an object, and something else")
            _join(inside, value, schema, f"{name}.")
        elif whole.setdefault(key) is not None:
            raise NotPlainError("a name is an object, and something else")


def line_struct(fields: Sequence[Any], names: Mapping[str, str]) -> Any:
    """The type that lines with these fields, and no others, are decoded to."""
    return msgspec.defstruct(
        "Line", fields, rename=dict(names), forbid_unknown_fields=True, gc=False
    )


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
        if name in schema.signals:
            type_ = _SCALAR
            shape.places[name] = place + own
        elif name in schema.events:
            type_ = _EVENT
            shape.places[name] = place + own
        elif isinstance(value, dict):
            before = len(shape.places), len(shape.ignored)
            inside = _fields(value, f"{name}.", f"{place}{own}.", schema, shape)
            leaves = islice(shape.places.values(), before[0], None)
            others = islice(shape.ignored.values(), before[1], None)
            shape.objects.append([*leaves, *others])
            object_ = line_struct(*inside)
            fields.append((own, object_, msgspec.field(default_factory=object_)))
            continue
        else:
            type_ = _ANYTHING
            shape.ignored[name] = place + own
        fields.append((own, type_, msgspec.UNSET))
    return fields, names


def _cells(rows: Sequence[Any], place: str) -> list[Any]:
    return list(map(attrgetter(place), rows))


def instants_of(stamps: list[Any], unit: Stamps) -> NDArray[np.int64]:
    """The ticks of some stamps.

    Raises:
        NotPlainError: they are no plain numbers, or out of range.
    """
    found = np.array(stamps)
    if found.dtype.kind not in ("i" if unit.unit == "ns" else "fi"):
        raise NotPlainError("its stamps are no plain numbers")
    try:
        return ticks_of_column(found, unit)
    except TraceError:  # whoever reads lines says in which it is
        raise NotPlainError("some instant is out of range") from None


def _occurrences(
    rows: Sequence[Any], place: str, fields: Mapping[str, Kind], schema: Schema
) -> Occurrences:
    cells = _cells(rows, place)
    payloads = {
        name: cells_of_values(
            [
                one.get(name, msgspec.UNSET) if isinstance(one, dict) else msgspec.UNSET
                for one in cells
            ],
            kind,
            schema.gaps,
            msgspec.UNSET,
        )
        for name, kind in fields.items()
    }
    occurs = [True if isinstance(one, dict) else one for one in cells]
    if schema.gaps.no_update is not None or any(one == {} for one in cells):
        raise NotPlainError("an event is something else")
    own = cells_of_values(occurs, Kind.BOOL, schema.gaps, msgspec.UNSET)
    says = np.where(own.values, np.uint8(YES), np.uint8(NO))
    if own.says is not None:
        says = np.where(own.says == YES, says, own.says)
    return Occurrences(says, payloads)
