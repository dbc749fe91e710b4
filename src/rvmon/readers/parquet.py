"""Parquet: a time column, a column per signal, event or payload field, as in CSV.

Needs pyarrow, the extra `arrow`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rvmon.errors import RvmonError, TraceError
from rvmon.readers.blocks import Block, NotPlainError
from rvmon.readers.columns import values_of_cells
from rvmon.readers.csv_rows import Column, Layout, read_layout
from rvmon.readers.tables import arrow_cells
from rvmon.readers.values import shorten
from rvmon.trace.sample import Value
from rvmon.trace.schema import Kind, Schema, Stamps
from rvmon.trace.stamps import ticks_of_stamp
from rvmon.trace.time import TIME_LIMIT

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ROWS = 1 << 16
"""Rows that are in memory at a time."""

_FITTING = {Kind.BOOL: "b", Kind.INT: "i", Kind.REAL: "fi"}


def _opened(path: str | Path) -> Any:
    """The file.

    Raises:
        RvmonError: there is no pyarrow.
        TraceError: it is no Parquet file, or a damaged one.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise RvmonError(
            "Parquet needs pyarrow, which is not installed: pip install 'rvmon[arrow]'"
        ) from None
    try:
        return pyarrow.parquet.ParquetFile(path)
    except MemoryError:  # of Arrow, too: the file may be as it should be
        raise
    except pyarrow.ArrowException as error:
        raise TraceError(f"not a Parquet file ({_first_line(error)})") from None
    except OSError as error:
        if error.errno is not None:  # the system says why it cannot be opened
            raise
        raise _damage(error) from None


def _batches(path: str | Path, layout: Layout) -> Iterator[list[Any]]:
    """The column of stamps and those that the spec reads, as the layout has them, rows by rows.

    Raises:
        TraceError: it cannot be read to its end.
    """
    file = _opened(path)
    import pyarrow

    places = [layout.time, *(column.index for column in layout.columns)]
    names = [layout.header[place] for place in places]
    batches = file.iter_batches(ROWS, columns=names)
    while True:
        try:
            batch = next(batches)
        except StopIteration:
            return
        except MemoryError:
            raise
        except (pyarrow.ArrowException, OSError) as error:
            raise _damage(error) from None
        yield [batch.column(name) for name in names]


def _damage(error: Exception) -> TraceError:
    if "launch worker thread" in str(error):  # its stack needs memory, too
        raise MemoryError
    return TraceError(f"damaged Parquet file ({_first_line(error)}): write or copy it again")


def _first_line(error: Exception) -> str:
    return shorten(str(error).partition("\n")[0], 120)


def parquet_layout(path: str | Path, schema: Schema) -> Layout:
    """What the file's columns are.

    Raises:
        RvmonError: there is no pyarrow.
        TraceError: it is no Parquet file, or has no time column or two.
    """
    return read_layout(list(_opened(path).schema_arrow.names), schema)


def parquet_blocks(
    path: str | Path, schema: Schema, fillable: frozenset[str] = frozenset()
) -> Iterator[Block]:
    """Read a file of numbers and truth values.

    Args:
        path: of the file.
        schema: the declared names.
        fillable: the names of which "no update" may be read as what was there before: of signals
            the value, of events that they do not occur.

    Raises:
        NotPlainError: there are gaps of other names or before the first value, payloads or labels,
            or the instants do not increase or are out of range; or the file is damaged.
    """
    try:
        yield from _plain_blocks(path, schema, fillable)
    except TraceError:  # whoever reads rows says in which it is
        raise NotPlainError("it cannot be read in blocks") from None


def _plain_blocks(path: str | Path, schema: Schema, fillable: frozenset[str]) -> Iterator[Block]:
    layout = parquet_layout(path, schema)
    columns = layout.columns
    if any(column.field is not None or column.kind is Kind.LABEL for column in columns):
        raise NotPlainError("a column holds no numbers or truth values")
    last = -TIME_LIMIT
    held: dict[str, Any] = {}
    for stamps, *batch in _batches(path, layout):
        times = _instants(stamps, layout.stamps)
        if not len(times) or times[0] <= last or not (times[1:] > times[:-1]).all():
            raise NotPlainError("its instants do not increase")
        last = int(times[-1])
        found = {}
        for column, cells in zip(columns, batch, strict=True):
            gaps = column.name in fillable
            if column in layout.events:
                found[column.name] = _occurrences(cells, gaps=gaps)
                continue
            found[column.name] = _values_held(cells, column, held, gaps=gaps)
            held[column.name] = found[column.name][-1]
        yield Block(times, found)


def _instants(column: Any, stamps: Stamps) -> NDArray[np.int64]:
    from rvmon.readers.ticks import ticks_of_column

    if column.null_count or stamps.unit == "iso":
        raise NotPlainError("its stamps are no plain numbers")
    return ticks_of_column(_array_of(column, "i" if stamps.unit == "ns" else "fi"), stamps)


def _array_of(column: Any, kinds: str) -> NDArray[Any]:
    array: NDArray[Any] = column.to_numpy(zero_copy_only=False)
    if array.dtype.kind not in kinds:
        raise NotPlainError("a column holds other values than were declared")
    return array


def _occurrences(column: Any, *, gaps: bool) -> NDArray[Any]:
    """Where an event occurs; a null says that it does not."""
    from pyarrow import types

    if not types.is_boolean(column.type) or (column.null_count and not gaps):
        raise NotPlainError("an event has payloads, or gaps that may matter")
    return _array_of(column.fill_null(False) if column.null_count else column, "b")


def _values_held(
    cells: Any, column: Column, held: Mapping[str, Any], *, gaps: bool
) -> NDArray[Any]:
    """A signal of which nulls hold the value above them, the first ones that of the batch before.

    Raises:
        NotPlainError: there is none; or the values are of another kind.
    """
    import numpy as np

    from rvmon.readers.held import held_values

    kinds = _FITTING[column.kind]
    if not cells.null_count:
        return _array_of(cells, kinds)
    if not gaps:
        raise NotPlainError("a signal has gaps that may matter")
    some = _array_of(cells.drop_null(), kinds)
    return held_values(some, np.asarray(cells.is_valid()), held.get(column.name))


def parquet_samples(
    path: str | Path, schema: Schema
) -> Iterator[tuple[int, int, Mapping[str, Value]]]:
    """Row number from 1, ticks and values of each row; a null is no update.

    Raises:
        RvmonError: there is no pyarrow.
        TraceError: with the row's number.
    """
    layout = parquet_layout(path, schema)
    row = 0
    for batch in _batches(path, layout):
        for stamp, *cells in zip(*map(arrow_cells, batch), strict=True):
            row += 1
            try:
                t = ticks_of_stamp(stamp, layout.stamps)
            except TraceError as error:
                raise TraceError(f"row {row}: {error}") from None
            yield row, t, values_of_cells(layout, cells)
