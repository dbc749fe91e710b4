"""Tables in memory, of any library, as columns by name.

Accepted are Arrow tables, objects with `__arrow_c_stream__` or `__dataframe__` (these need pyarrow,
the extra `arrow`), data frames of pandas and polars, and mappings of arrays or lists.
"""

from __future__ import annotations

import reprlib
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rvmon.errors import TraceError, needed


def columns_by_name(table: Any) -> dict[str, Any] | None:
    """The columns of a table, not converted; `None` if the object is no table.

    Raises:
        TraceError: two columns have the same name, or the table cannot be read.
        RvmonError: pyarrow is needed and not installed.

    >>> columns_by_name({"t": [0, 1]}), columns_by_name([(0, {})])
    ({'t': [0, 1]}, None)
    """
    if isinstance(table, Mapping):
        return {str(name): column for name, column in table.items()}
    if hasattr(table, "column_names"):
        return _distinct(table.column_names, table.columns)
    if not (hasattr(table, "__arrow_c_stream__") or hasattr(table, "__dataframe__")):
        return None
    # Arrow would turn NaN in a pandas frame into null; the frame's own columns distinguish them.
    if hasattr(table, "columns") and hasattr(table, "shape"):
        return _frame_columns(table)
    imported = _imported(table)
    return _distinct(imported.column_names, imported.columns)


def _frame_columns(frame: Any) -> dict[str, Any]:
    keys = list(frame.columns)
    found = _distinct([str(key) for key in keys], [frame[key] for key in keys])
    index: Any = getattr(frame, "index", None)  # only pandas has one; it may hold the stamps
    if getattr(index, "name", None) is not None:
        found.setdefault(str(index.name), index)
    elif getattr(getattr(index, "dtype", None), "kind", "") in ("m", "M") and "t_ns" not in found:
        found.setdefault("t", index)
    return found


def _imported(table: Any) -> Any:
    """Import a table as an Arrow table."""
    kind = type(table).__name__
    with needed(kind, "pyarrow"):
        import pyarrow
        from pyarrow.interchange import from_dataframe
    try:
        return (
            pyarrow.table(table) if hasattr(table, "__arrow_c_stream__") else from_dataframe(table)
        )
    except (pyarrow.ArrowException, TypeError, ValueError, RuntimeError) as error:
        cause = str(error).partition("\n")[0]
        raise TraceError(f"{kind} cannot be read as a table of columns ({cause})") from None


def _distinct(names: Sequence[str], columns: Sequence[Any]) -> dict[str, Any]:
    found = dict(zip(names, columns, strict=True))
    if len(found) < len(names):
        [(name, _)] = Counter(names).most_common(1)
        raise TraceError(f"column `{name}` appears twice in the table")
    return found


def cells_of(name: str, column: Any) -> list[Any]:
    """The cells of a column; dates and durations as text, as they are no numbers of seconds.

    Returns:
        Python values. `None` means that there is no value: null, masked, or missing in a pandas
        column whose type distinguishes missing values from NaN.

    Raises:
        TraceError: the object is no array or list.

    >>> cells_of("x", [1, None])
    [1, None]
    """
    if hasattr(column, "combine_chunks") or hasattr(column, "to_pylist"):
        return arrow_cells(column)
    dtype = getattr(column, "dtype", None)
    if getattr(column, "ndim", 1) > 0 and not isinstance(column, str | bytes):
        if getattr(dtype, "kind", None) in ("m", "M"):
            return [str(cell) for cell in column]
        if is_of_dates(column):  # polars, whose lists drop nanoseconds
            return [str(cell) for cell in column.to_numpy()]
        try:
            listed = getattr(column, "tolist", None) or getattr(column, "to_list", None)
            cells = list(listed() if listed else column)
        except TypeError:
            cells = None
        if cells is not None:
            return _without_missing(column, cells) if hasattr(column, "isna") else cells
    found = reprlib.repr(column)
    raise TraceError(f"column `{name}`: expected an array or a list of values, found {found}")


def is_of_dates(column: Any) -> bool:
    """Whether the type of a column says that its cells are dates with a time.

    >>> import numpy
    >>> is_of_dates(numpy.array(["2024-05-01"], "datetime64[ns]")), is_of_dates([0.5])
    (True, False)
    """
    dtype = getattr(column, "dtype", getattr(column, "type", None))
    return getattr(dtype, "kind", None) == "M" or str(dtype).startswith(("Datetime", "timestamp["))


def is_of_durations(column: Any) -> bool:
    """Whether the type of a column says that its cells are durations.

    >>> import numpy
    >>> is_of_durations(numpy.array([1], "timedelta64[s]")), is_of_durations([0.5])
    (True, False)
    """
    dtype = getattr(column, "dtype", getattr(column, "type", None))
    return getattr(dtype, "kind", None) == "m" or str(dtype).startswith(("Duration", "duration["))


def nanoseconds_of(column: Any) -> Any:
    """Durations as whole nanoseconds, int64[n]; a list with `None` where a duration is missing.

    >>> import numpy
    >>> nanoseconds_of(numpy.array([1, "NaT"], "timedelta64[us]"))
    [1000, None]
    """
    found = np.asarray(column, "timedelta64[ns]")
    whole = found.astype(np.int64)
    gone = np.isnat(found)
    if not gone.any():
        return whole
    return [None if none else int(one) for none, one in zip(gone, whole, strict=True)]


def _without_missing(series: Any, cells: list[Any]) -> list[Any]:
    """The cells of a pandas column, `None` where one is missing.

    Columns of NumPy types cannot tell a missing value from NaN, so their cells stay as they are.
    """
    if type(series.dtype).__module__.partition(".")[0] == "numpy":
        return cells
    return [None if gone else cell for gone, cell in zip(series.isna(), cells, strict=True)]


def arrow_cells(column: Any) -> list[Any]:
    """The cells of an Arrow array; dates and durations as text, like `cells_of`."""
    from pyarrow import types

    if types.is_temporal(column.type):
        return [str(cell) for cell in column.to_numpy(zero_copy_only=False)]
    cells: list[Any] = column.to_pylist()
    return cells
