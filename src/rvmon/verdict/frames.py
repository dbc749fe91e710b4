"""Verdicts as tables of Arrow, pandas and polars."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, get_args, get_type_hints

from rvmon.errors import not_installed
from rvmon.verdict.rows import VerdictRow

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


def column_types() -> dict[str, type]:
    """The type of each column of verdicts; all but texts and truths may be null."""
    hints = get_type_hints(VerdictRow)
    return {name: (get_args(hint) or (hint,))[0] for name, hint in hints.items()}


def arrow_table(rows: Iterable[VerdictRow], about: Mapping[str, str]) -> pyarrow.Table:
    """Rows as a table of Arrow.

    Raises:
        RvmonError: pyarrow is needed.
    """
    try:
        import pyarrow
    except ImportError:
        raise not_installed("this table", "pyarrow") from None
    types = {
        str: pyarrow.string(),
        int: pyarrow.int64(),
        float: pyarrow.float64(),
        bool: pyarrow.bool_(),
    }
    schema = pyarrow.schema(
        {name: types[kind] for name, kind in column_types().items()},
        metadata={f"rvmon.{key}": text for key, text in about.items()},
    )
    columns = list(zip(*rows, strict=True)) or [() for _ in schema]
    return pyarrow.table(dict(zip(schema.names, columns, strict=True)), schema=schema)


def pandas_frame(table: pyarrow.Table) -> pandas.DataFrame:
    """A table of verdicts as a data frame of pandas; instants stay whole numbers, also where null.

    Raises:
        RvmonError: pandas is needed.
    """
    try:
        import pandas
    except ImportError:
        raise not_installed("this table", "pandas") from None
    import pyarrow

    whole = {pyarrow.int64(): pandas.Int64Dtype()}
    frame: pandas.DataFrame = table.to_pandas(types_mapper=whole.get)
    return frame


def polars_frame(table: pyarrow.Table) -> polars.DataFrame:
    """A table of verdicts as a data frame of polars.

    Raises:
        RvmonError: polars is needed.
    """
    try:
        import polars
    except ImportError:
        raise not_installed("this table", "polars") from None
    frame = polars.from_arrow(table)
    assert isinstance(frame, polars.DataFrame)  # noqa: S101 - as a table is no column
    return frame
