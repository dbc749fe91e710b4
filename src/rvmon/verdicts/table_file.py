"""Files of verdicts: writes and reads CSV, Parquet and SQLite, and reads JSON."""

from __future__ import annotations

import csv
import sqlite3
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NoReturn

import msgspec

from rvmon.errors import RvmonError, TraceError, needed, not_installed, writing
from rvmon.files import write_whole
from rvmon.verdicts import Verdict
from rvmon.verdicts.report import Report
from rvmon.verdicts.serialise import VerdictRow, arrow_table, broken_rows, column_types

TABLE = "verdicts"  # the name of the table in a database; the table `about` has the metadata

_SQL_TYPES = {str: "TEXT", int: "INTEGER", float: "REAL", bool: "INTEGER"}


def refuse_format(path: str | Path) -> None:
    """Refuse an unsupported output file before anything is judged.

    Raises:
        RvmonError: the suffix is unknown, or a package for it is not installed.
    """
    _, packages = _form(path)
    for package in packages:
        if find_spec(package) is None:
            raise not_installed("this table", package)


def write_results(path: str | Path, rows: Iterable[VerdictRow], about: Mapping[str, str]) -> None:
    """Write verdicts to a file in the format of its suffix; an existing file is replaced.

    Raises:
        RvmonError: the suffix is unknown, a package is missing, or the file cannot be written.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     write_results(f"{folder}/v.csv", [VerdictRow("a.csv", "R1", verdict="NT")], {})
    ...     Path(folder, "v.csv").read_text().splitlines()[1]
    'a.csv,R1,,,NT,,false,,,,,,,,,'
    """
    written, _ = _form(path)
    with writing(path):
        write_whole(path, written(rows, about))


def csv_bytes(rows: Iterable[VerdictRow], _: Mapping[str, str] | None = None) -> bytes:
    """Verdicts as the bytes of a CSV file."""
    place = VerdictRow._fields.index("in_doubt")
    truths = ("false", "true")
    shown = ([*row[:place], truths[row.in_doubt], *row[place + 1 :]] for row in rows)
    return csv_table(VerdictRow._fields, shown)


def csv_table(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> bytes:
    """Rows as the bytes of a CSV file in UTF-8, with a header."""
    lines = _Lines()
    writer = csv.writer(lines)
    writer.writerow(columns)
    writer.writerows(rows)
    return "".join(f"{line[:-2]}\n" for line in lines).encode("utf-8")


class _Lines(list[str]):
    """Collects lines that end in CRLF; with LF, the csv module would not quote a lone CR."""

    def write(self, line: str) -> None:
        self.append(line)


def _parquet(rows: Iterable[VerdictRow], about: Mapping[str, str]) -> bytes:
    import pyarrow
    from pyarrow import parquet

    sink = pyarrow.BufferOutputStream()
    parquet.write_table(arrow_table(rows, about), sink, compression="zstd")
    return sink.getvalue().to_pybytes()  # type: ignore[no-any-return]  # pyarrow has no types


def _sqlite(rows: Iterable[VerdictRow], about: Mapping[str, str]) -> bytes:
    columns = ", ".join(f"{name} {_SQL_TYPES[kind]}" for name, kind in column_types().items())
    holes = ", ".join("?" * len(VerdictRow._fields))
    # Built in memory, so that the file is written as a whole, as in the other formats.
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


_Written = Callable[[Iterable[VerdictRow], Mapping[str, str]], bytes]

_FORMS: dict[str, tuple[_Written, tuple[str, ...]]] = {
    ".csv": (csv_bytes, ()),
    ".parquet": (_parquet, ("pyarrow",)),
    ".sqlite": (_sqlite, ()),
}
"""By suffix of the file: the writer, and the packages that it needs."""


def _form(path: str | Path) -> tuple[_Written, tuple[str, ...]]:
    return _FORMS.get(Path(path).suffix.lower()) or refuse(path, _FORMS)


def refuse(path: str | Path, forms: Iterable[str]) -> NoReturn:
    """Raise the error for a file whose suffix is not one of `forms`."""
    raise RvmonError(f"{path}: verdicts are stored in files that end in {', '.join(forms)}")


_KEPT = ("recording", "requirement", "attempt", "verdict", "reason", "error")
"""The columns that are read back."""


def read_results(path: str | Path) -> list[VerdictRow]:
    """Read verdicts that `rvmon run` wrote: with `--out`, or as JSON with `--format json`.

    Only the columns recording, requirement, attempt, verdict, reason and error are read.

    Raises:
        RvmonError: the file does not exist, cannot be read, or contains no verdicts.
    """
    forms = {
        ".csv": _read_csv,
        ".parquet": _read_parquet,
        ".sqlite": _read_sqlite,
        ".json": _read_json,
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
        raise RvmonError(f"{path} contains no verdicts of rvmon: {cause}") from None


def _checked(values: Iterable[Any]) -> VerdictRow:
    recording, requirement, attempt, verdict, reason, error = values
    if verdict is not None:
        Verdict(verdict)
    texts = (recording, requirement or "", attempt or "", reason, error)
    if not all(isinstance(text, str) for text in texts):
        raise ValueError("a name or a reason is not text")
    return VerdictRow(
        recording, requirement or None, attempt or None, verdict=verdict, reason=reason, error=error
    )


def _read_csv(path: str) -> Iterator[Iterable[Any]]:
    with open(path, encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        if lacking := set(_KEPT).difference(reader.fieldnames or ()):
            raise ValueError(f"it has no column {', '.join(sorted(lacking))}")
        for row in reader:
            values = {name: row[name] for name in _KEPT}
            yield (values | {"verdict": values["verdict"] or None}).values()


def _read_parquet(path: str) -> Iterator[Iterable[Any]]:
    with needed("this table", "pyarrow"):
        from pyarrow import ArrowException, parquet
    try:
        table = parquet.read_table(path, columns=list(_KEPT))
    except ArrowException as error:
        raise ValueError(error) from None
    return zip(*(table.column(name).to_pylist() for name in _KEPT), strict=True)


_SELECT = f"SELECT {', '.join(_KEPT)} FROM {TABLE}"  # noqa: S608 - our words


def _read_sqlite(path: str) -> Iterable[Iterable[Any]]:
    database = sqlite3.connect(f"{Path(path).absolute().as_uri()}?mode=ro", uri=True)
    try:
        # The file is not trusted: functions in its views and indexes are not called.
        database.execute("PRAGMA trusted_schema = OFF")
        return database.execute(_SELECT).fetchall()
    finally:
        database.close()


def _read_json(path: str) -> Iterator[Iterable[Any]]:
    decoded = msgspec.json.decode(Path(path).read_bytes())
    for report in decoded if isinstance(decoded, list) else [decoded]:
        if "error" in report:
            rows = broken_rows(report["trace"], report["error"], ())
        else:
            rows = Report.from_json(msgspec.json.encode(report)).rows()
        for row in rows:
            yield (getattr(row, name) for name in _KEPT)


_FAULTS = (
    TraceError,
    sqlite3.Error,
    csv.Error,
    msgspec.MsgspecError,
    KeyError,
    ValueError,
    TypeError,
)
"""The exceptions that can arise when a file does not contain verdicts."""
