"""Verdicts read back from a file that was written before."""

from __future__ import annotations

import csv
import sqlite3
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from rvmon.errors import RvmonError, TraceError, not_installed
from rvmon.verdict.report import Report
from rvmon.verdict.rows import broken_rows
from rvmon.verdict.verdict import Verdict
from rvmon.verdict.write_rows import TABLE, refuse


class Kept(NamedTuple):
    """What of a row of `rvmon.verdict.rows` is read back; the names are the same."""

    recording: str
    requirement: str | None
    attempt: str | None
    verdict: str | None
    reason: str
    error: str


def read_results(path: str | Path) -> list[Kept]:
    """Read verdicts that `rvmon run` wrote: with `--out`, or as JSON with `--format json`.

    Raises:
        RvmonError: there is no such file, it holds something else, or a package is missing.
    """
    forms = {
        ".csv": _csv,
        ".parquet": _parquet,
        ".sqlite": _sqlite,
        ".db": _sqlite,
        ".duckdb": _duckdb,
        ".json": _json,
    }
    read = forms.get(Path(path).suffix.lower()) or refuse(path, forms)
    if not Path(path).is_file():
        raise RvmonError(f"there is no file {path}: `rvmon run … --out {path}` writes it")
    try:
        return [_checked(row) for row in read(str(path))]
    except OSError as error:
        raise RvmonError(f"cannot read {path}: {error.strerror or error}") from None
    except _FAULTS as error:
        cause = (str(error).splitlines() or [type(error).__name__])[0]
        raise RvmonError(f"{path} holds no verdicts of rvmon: {cause}") from None


def _checked(values: Iterable[Any]) -> Kept:
    recording, requirement, attempt, verdict, reason, error = values
    if verdict is not None:
        Verdict(verdict)
    texts = (recording, requirement or "", attempt or "", reason, error)
    if not all(isinstance(text, str) for text in texts):
        raise ValueError("a name or a reason is no text")
    return Kept(recording, requirement or None, attempt or None, verdict, reason, error)


def _csv(path: str) -> Iterator[Iterable[Any]]:
    with open(path, encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        if lacking := set(Kept._fields).difference(reader.fieldnames or ()):
            raise ValueError(f"it has no column {', '.join(sorted(lacking))}")
        for row in reader:
            values = {name: row[name] for name in Kept._fields}
            yield (values | {"verdict": values["verdict"] or None}).values()


def _parquet(path: str) -> Iterator[Iterable[Any]]:
    try:
        from pyarrow import ArrowException, parquet
    except ImportError:
        raise not_installed("this table", "pyarrow") from None
    try:
        table = parquet.read_table(path, columns=list(Kept._fields))
    except ArrowException as error:
        raise ValueError(error) from None
    return zip(*(table.column(name).to_pylist() for name in Kept._fields), strict=True)


_SELECT = f"SELECT {', '.join(Kept._fields)} FROM {TABLE}"  # noqa: S608 - our words


def _sqlite(path: str) -> Iterable[Iterable[Any]]:
    database = sqlite3.connect(f"{Path(path).absolute().as_uri()}?mode=ro", uri=True)
    try:
        database.execute("PRAGMA trusted_schema = OFF")
        return database.execute(_SELECT).fetchall()
    finally:
        database.close()


def _duckdb(path: str) -> Iterable[Iterable[Any]]:
    try:
        import duckdb
    except ImportError:
        raise not_installed("this table", "duckdb") from None
    config: dict[str, Any] = {"enable_external_access": "false"}  # a view could read other files
    try:
        with duckdb.connect(path, read_only=True, config=config) as database:
            return database.execute(_SELECT).fetchall()
    except duckdb.Error as error:
        raise ValueError(error) from None


def _json(path: str) -> Iterator[Iterable[Any]]:
    found = msgspec.json.decode(Path(path).read_bytes())
    for report in found if isinstance(found, list) else [found]:
        if "error" in report:
            rows = broken_rows(report["trace"], report["error"], ())
        else:
            rows = Report.from_json(msgspec.json.encode(report)).rows()
        for row in rows:
            yield (getattr(row, name) for name in Kept._fields)


_FAULTS = (
    TraceError,
    sqlite3.Error,
    csv.Error,
    msgspec.MsgspecError,
    KeyError,
    ValueError,
    TypeError,
)
"""What reading something else raises."""
