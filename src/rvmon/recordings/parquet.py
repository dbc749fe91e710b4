"""Reading of Parquet files: a time column, and a column per signal, event or payload field.

Needs pyarrow, the extra `arrow`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from rvmon.errors import TraceError, needed
from rvmon.recordings.batch import NotPlainError
from rvmon.recordings.csv_rows import Layout, read_layout
from rvmon.recordings.places import is_short_of_memory
from rvmon.recordings.rows import Row
from rvmon.recordings.table_recording import batch_of_table, rows_of_cells, stamps_of_column
from rvmon.recordings.tables import arrow_cells, is_of_durations, nanoseconds_of
from rvmon.recordings.values import first_line
from rvmon.trace.schema import Schema

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch

ROWS = 1 << 16  # the most rows that are in memory at a time


def parquet_file(path: str | Path) -> Any:
    """Open a file as a `pyarrow.parquet.ParquetFile`.

    Raises:
        TraceError: the file is no Parquet file, or damaged.
        RvmonError: pyarrow is not installed.
        OSError: the file cannot be opened.
    """
    with needed("Parquet", "pyarrow"):
        import pyarrow
        import pyarrow.parquet
    try:
        return pyarrow.parquet.ParquetFile(path, page_checksum_verification=True)
    except MemoryError:  # Arrow's is an `ArrowException`, too, but says nothing about the file
        raise
    except pyarrow.ArrowException as error:
        raise TraceError(f"not a Parquet file ({first_line(error)})") from None
    except OSError as error:
        if error.errno is not None:  # an error of the system, not of Arrow
            raise
        raise _damage(error) from None


def parquet_cells(path: str | Path) -> Iterator[Mapping[str, list[Any]]]:
    """Yield the cells of all columns by name, at most `ROWS` rows at a time.

    One number may stand for all numbers of its column.
    """
    names = list(parquet_file(path).schema_arrow.names)
    for arrays in parquet_batches(path, names):
        yield dict(zip(names, map(_different, arrays), strict=True))


def _different(column: Any) -> list[Any]:
    from pyarrow import types

    type_ = column.type
    if types.is_boolean(type_) or types.is_signed_integer(type_) or types.is_floating(type_):
        column = column.drop_null()[:1]
    elif types.is_string(type_) or types.is_dictionary(type_):
        column = column.unique()
    return arrow_cells(column)


def parquet_batches(path: str | Path, names: list[str]) -> Iterator[list[Any]]:
    """Yield the arrays of these columns, at most `ROWS` rows at a time."""
    file = parquet_file(path)
    import pyarrow

    threads = not is_short_of_memory()
    batches = file.iter_batches(ROWS, columns=names, use_threads=threads)
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
    if "launch worker thread" in str(error):  # there is no memory for the thread's stack
        raise MemoryError
    return TraceError(f"damaged Parquet file ({first_line(error)}): write or copy it again")


def parquet_layout(path: str | Path, schema: Schema) -> Layout:
    """The layout of the file's columns."""
    fields = parquet_file(path).schema_arrow
    layout = read_layout(list(fields.names), schema)
    field = fields.field(layout.stamps.column)
    return replace(layout, stamps=stamps_of_column(layout.stamps, field))


def numbers_of_durations(column: Any) -> Any:
    """A column of stamps; durations become nanoseconds, the unit `parquet_layout` gives them."""
    import pyarrow

    if not is_of_durations(column):
        return column
    return pyarrow.array(nanoseconds_of(column), pyarrow.int64())


def parquet_batches_of(path: str | Path, schema: Schema) -> Iterator[Batch | Iterator[Row]]:
    """Yield the rows of a file in order: as a batch if all its cells fit, else one by one."""
    layout = parquet_layout(path, schema)
    row = 1
    for given, *others in parquet_batches(path, layout.names_read):
        arrays = [numbers_of_durations(given), *others]
        try:
            columns = dict(zip(layout.names_read, arrays, strict=True))
            yield replace(batch_of_table(columns, layout), first=row)
        except NotPlainError:
            yield rows_of_cells(map(arrow_cells, arrays), layout, row)
        row += len(given)
