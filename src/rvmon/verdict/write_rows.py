"""Verdicts written as a table: CSV, Parquet, SQLite or DuckDB."""

from __future__ import annotations

import csv
import sqlite3
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NoReturn

from rvmon.errors import RvmonError, not_installed
from rvmon.verdict.frames import arrow_table, column_types
from rvmon.verdict.rows import VerdictRow
from rvmon.writing import write_whole

TABLE = "verdicts"
"""The table in a database; beside it `about` says what judged."""

_SQL_TYPES = {str: "TEXT", int: "INTEGER", float: "REAL", bool: "INTEGER"}


def refuse_format(path: str | Path) -> None:
    """Say, before anything is judged, that verdicts cannot be written in the form of a file.

    Raises:
        RvmonError: no form is named so, or a package is missing.
    """
    _, packages = _form(path)
    for package in packages:
        if find_spec(package) is None:
            raise not_installed("this table", package)


def write_results(path: str | Path, rows: Iterable[VerdictRow], about: Mapping[str, str]) -> None:
    """Write verdicts to a file, whose name says in which form; one that is there is replaced.

    Args:
        path: ends in `.csv`, `.parquet`, `.sqlite`, `.db` or `.duckdb`.
        rows: the verdicts.
        about: what judged, by key; a CSV file has no place for it.

    Raises:
        RvmonError: there is no such form, a package is missing, or the file cannot be written.

    >>> with TemporaryDirectory() as folder:
    ...     write_results(f"{folder}/v.csv", [VerdictRow("a.csv", "R1", verdict="NT")], {})
    ...     Path(folder, "v.csv").read_text().splitlines()[1]
    'a.csv,R1,,,NT,,false,,,,,,,,,'
    """
    written, _ = _form(path)
    try:
        write_whole(path, written(rows, about))
    except OSError as error:
        raise RvmonError(f"cannot write {path}: {error.strerror or error}") from None


def csv_bytes(rows: Iterable[VerdictRow], _: Mapping[str, str] | None = None) -> bytes:
    """Verdicts as a file in CSV."""
    place = VerdictRow._fields.index("in_doubt")
    truths = ("false", "true")
    shown = ([*row[:place], truths[row.in_doubt], *row[place + 1 :]] for row in rows)
    return csv_table(VerdictRow._fields, shown)


def csv_table(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> bytes:
    """Rows as a file in CSV, UTF-8, below the names of their columns."""
    lines = _Lines()
    writer = csv.writer(lines)
    writer.writerow(columns)
    writer.writerows(rows)
    return "".join(f"{line[:-2]}\n" for line in lines).encode("utf-8")


class _Lines(list[str]):
    """Takes lines that end in both signs: of others a writer would not quote a carriage return."""

    def write(self, line: str) -> None:
        self.append(line)


def _parquet(rows: Iterable[VerdictRow], about: Mapping[str, str]) -> bytes:
    import pyarrow
    from pyarrow import parquet

    sink = pyarrow.BufferOutputStream()
    parquet.write_table(arrow_table(rows, about), sink, compression="zstd")
    return sink.getvalue().to_pybytes()  # type: ignore[no-any-return]


def _sqlite(rows: Iterable[VerdictRow], about: Mapping[str, str]) -> bytes:
    columns = ", ".join(f"{name} {_SQL_TYPES[kind]}" for name, kind in column_types().items())
    holes = ", ".join("?" * len(VerdictRow._fields))
    database = sqlite3.connect(":memory:")
    try:
        database.execute(f"CREATE TABLE {TABLE} ({columns})")
        database.execute("CREATE TABLE about (key TEXT, value TEXT)")
        database.executemany(f"INSERT INTO {TABLE} VALUES ({holes})", rows)  # noqa: S608 - ours
        database.executemany("INSERT INTO about VALUES (?, ?)", about.items())
        database.commit()
        return database.serialize()
    finally:
        database.close()


def _duckdb(rows: Iterable[VerdictRow], about: Mapping[str, str]) -> bytes:
    import duckdb

    with TemporaryDirectory() as folder:
        path = Path(folder, "verdicts.duckdb")
        with duckdb.connect(str(path)) as database:
            database.register("rows", arrow_table(rows, {}))
            database.execute(f"CREATE TABLE {TABLE} AS SELECT * FROM rows")  # noqa: S608 - ours
            database.execute("CREATE TABLE about (key VARCHAR, value VARCHAR)")
            if about:
                database.executemany("INSERT INTO about VALUES (?, ?)", [*about.items()])
        return path.read_bytes()


_Written = Callable[[Iterable[VerdictRow], Mapping[str, str]], bytes]

_FORMS: dict[str, tuple[_Written, tuple[str, ...]]] = {
    ".csv": (csv_bytes, ()),
    ".parquet": (_parquet, ("pyarrow",)),
    ".sqlite": (_sqlite, ()),
    ".db": (_sqlite, ()),
    ".duckdb": (_duckdb, ("pyarrow", "duckdb")),
}
"""By the end of a file's name: what writes it, and the packages that this needs."""


def _form(path: str | Path) -> tuple[_Written, tuple[str, ...]]:
    return _FORMS.get(Path(path).suffix.lower()) or refuse(path, _FORMS)


def refuse(path: str | Path, forms: Iterable[str]) -> NoReturn:
    """Say that a file's name ends in none of these."""
    raise RvmonError(f"{path}: verdicts are kept in files that end in {', '.join(forms)}")
