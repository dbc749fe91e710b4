"""Reading of JSON lines in pieces: as batches of columns where a piece is plain, else by rows."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO

import msgspec
import numpy as np
from msgspec.structs import replace

from rvmon.errors import TraceError
from rvmon.recordings import places
from rvmon.recordings.batch import Batch, NotPlainError, Occurrences
from rvmon.recordings.cells import cells_of_values, occurrences
from rvmon.recordings.jsonl_rows import bound, count_of_names, jsonl_samples, names_in
from rvmon.recordings.rows import Row
from rvmon.recordings.table_recording import ticks_of_column
from rvmon.trace.schema import Kind, Schema, Stamps
from rvmon.trace.stamps import DEFAULT_COLUMNS, stamps_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DECODER = msgspec.json.Decoder(dict[str, Any])

_WITH_NAMES = {dict, list}
_OBJECTS = {dict, msgspec.UnsetType}

_MARK = b"\xef\xbb\xbf"


def jsonl_batches(
    file: BinaryIO, schema: Schema, ignored: Counter[str], found_stamps: Callable[[Stamps], None]
) -> Iterator[Batch | Iterator[Row]]:
    """Yield the rows of a text in order: as batches where possible, else one by one.

    `ignored` counts undeclared names; `found_stamps` is called with the default stamps of the text.
    """
    line = 0
    for text in places.whole_pieces(file, places.BLOCK):
        if not line and schema.stamps is None:
            first = text.partition(b"\n")[0]
            found_stamps(stamps_of("t_ns" if b'"t_ns"' in first else "t"))
        try:
            batch = _batch(text.removeprefix(b"" if line else _MARK), schema, ignored)
        except NotPlainError:
            lines = places.bounded_lines(io.StringIO(text.decode(), newline=""), line)
            yield jsonl_samples(lines, schema, ignored, line)
        else:
            yield replace(batch, first=line + 1)
        line += text.count(b"\n") + text.count(b"\r") - text.count(b"\r\n")


def _batch(text: bytes, schema: Schema, ignored: Counter[str]) -> Batch:
    """Convert a piece to a batch.

    Raises:
        NotPlainError: the piece must be read line by line.
    """
    lines = text.count(b"\n") + (not text.endswith(b"\n"))
    if schema.stamps is not None or schema.columns or b"\r" in text:
        raise NotPlainError("stamps or names have another form")
    try:
        rows = _DECODER.decode_lines(text)
        columns: dict[str, list[Any]] = {}
        others: Counter[str] = Counter()
        count = _collect(rows, "", schema, columns, others)
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        raise NotPlainError("a line is no object of JSON") from None
    stamps = [name for name in DEFAULT_COLUMNS if name in columns]
    # Blank lines, and the list `events`, are read by rows only.
    if len(rows) != lines or len(stamps) != 1 or "events" in others:
        raise NotPlainError("its lines have not one stamp")
    if names_in(text) != count:  # the decoder keeps only the last of equal names
        raise NotPlainError("a name may stand twice in a line")
    batch = Batch(
        instants_of(columns.pop(stamps[0]), stamps_of(stamps[0])),
        {
            name: cells_of_values(columns[name], kind, schema.gaps, msgspec.UNSET)
            for name, kind in schema.signals.items()
            if name in columns
        },
        {
            name: _occurrences(columns[name], fields, schema)
            for name, fields in schema.events.items()
            if name in columns
        },
    )
    ignored.update(others)
    bound(ignored)
    return batch


def _collect(
    objects: Sequence[Mapping[str, Any]],
    prefix: str,
    schema: Schema,
    columns: dict[str, list[Any]],
    others: Counter[str],
) -> int:
    """Collect the values of stamps and declared names in `columns`, and count undeclared names.

    Args:
        objects: an object per line, empty where the line has none.
        prefix: the path of the objects in their lines.
        schema: the declared names.
        columns: by name, a value per line, `UNSET` where the line has none.
        others: counts by undeclared name.

    Returns:
        The number of names in the objects, including nested ones.

    Raises:
        NotPlainError: two keys stand for one name, or a name has objects and other values.
    """
    count = sum(map(len, objects))
    for key in dict.fromkeys(chain.from_iterable(objects)):
        name = prefix + key
        cells = [one.get(key, msgspec.UNSET) for one in objects]
        types = set(map(type, cells))
        if name in columns or name in others:  # `a.b` beside `b` in `a`
            raise NotPlainError("two keys stand for one name")
        if name in schema.signals or name in schema.events or name in DEFAULT_COLUMNS:
            columns[name] = cells
        elif types <= _OBJECTS and dict in types:
            inner = [one if type(one) is dict else {} for one in cells]
            count += _collect(inner, f"{name}.", schema, columns, others)
            continue
        elif dict in types:
            raise NotPlainError("a name is an object, and something else")
        else:
            others[name] += len(cells) - cells.count(msgspec.UNSET)
        if not _WITH_NAMES.isdisjoint(types):
            count += sum(map(count_of_names, cells))
    return count


def instants_of(stamps: list[Any], unit: Stamps) -> NDArray[np.int64]:
    """Convert stamps to ticks, int64[n].

    Raises:
        NotPlainError: a stamp is no plain number, or out of range.
    """
    found = np.array(stamps if set(map(type, stamps)) <= {int, float} else [])
    if len(found) != len(stamps) or found.dtype.kind not in ("i" if unit.unit == "ns" else "fi"):
        raise NotPlainError("its stamps are no plain numbers")
    try:
        return ticks_of_column(found, unit)
    except TraceError:  # reading line by line reports the line
        raise NotPlainError("some instant is out of range") from None


def _occurrences(cells: Sequence[Any], fields: Mapping[str, Kind], schema: Schema) -> Occurrences:
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
    occurs = [True if isinstance(cell, dict) else cell for cell in cells]
    if schema.gaps.no_update is not None or any(cell == {} for cell in cells):
        raise NotPlainError("an event is something else")
    own = cells_of_values(occurs, Kind.BOOL, schema.gaps, msgspec.UNSET)
    return Occurrences(occurrences(own, (), len(cells)), payloads)
