"""Reader of a folder of tables that form one recording: a CSV file per topic, joined by time.

The file `topics.toml` marks such a folder; it may be empty.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from heapq import merge
from io import TextIOWrapper
from itertools import islice
from pathlib import Path
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from rvmon.errors import TraceError
from rvmon.recordings import TOPICS
from rvmon.recordings.csv_dialect import opened_as_csv
from rvmon.recordings.csv_rows import CopiedLines, read_layout, split_lines
from rvmon.recordings.messages import Message, Messages, Topic
from rvmon.recordings.places import bounded_lines, endings_of, named_errors
from rvmon.recordings.values import FALSE_WORDS, TRUE_WORDS, double_of
from rvmon.texts import did_you_mean, text_of_file
from rvmon.trace.schema import Kind, Schema, Stamps
from rvmon.trace.stamps import stamps_of, ticks_of_cell
from rvmon.trace.time import format_ticks

_LOOKED_AT = 1000  # rows that decide on the kinds of columns

_WHOLE = re.compile(r"[+-]?\d{1,18}", re.ASCII)
_PATH = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*(\[\d{1,4}\])?")


class _Table(Struct, frozen=True):
    """A file of a folder; `kinds`: by column except the stamps, the possible kinds."""

    path: Path
    type: str
    stamps: Stamps | None
    kinds: Mapping[str, Sequence[Kind]]


class TableMessages(Messages):
    """An open folder of tables."""

    def __init__(self, folder: Path) -> None:
        self._tables = {name: _with_kinds(table) for name, table in _tables(folder)}
        self.topics = {
            name: Topic(
                name,
                table.type,
                {_leaf(column): kinds[0] for column, kinds in table.kinds.items()},
                fault=_fault(table.kinds),
                doubtful=frozenset(_leaf(one) for one, kinds in table.kinds.items() if kinds[1:]),
            )
            for name, table in self._tables.items()
        }

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the rows of these topics by time; at one instant, in the order of the files."""
        rows = [_rows(name, table) for name, table in self._tables.items() if name in topics]
        yield from merge(*rows, key=lambda row: row[1])


def _tables(folder: Path) -> Iterator[tuple[str, _Table]]:
    """Yield topics with their files: those that `topics.toml` lists, or else all CSV files.

    Raises:
        TraceError: `topics.toml` is malformed, or there is no table.
    """
    place = folder / TOPICS
    try:
        content = tomllib.loads(text_of_file(place))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise TraceError(f"{place}: no TOML: {error}") from None
    _expect(content, ("time", "topics"), place)
    listed = content.get("topics") or {
        path.name.partition(".")[0]: path.name
        for path in sorted(folder.iterdir())
        if endings_of(path.name)[0] == ".csv"
    }
    if not isinstance(listed, dict) or not listed:
        raise TraceError(f"{folder}: there is no table: put .csv files next to {TOPICS}")
    for name, entry in listed.items():
        table = {"file": entry} if isinstance(entry, str) else entry
        if not isinstance(table, dict) or not isinstance(table.get("file"), str):
            raise TraceError(f'{place}: which file is `{name}`? {name} = "{name}.csv"')
        _expect(table, ("file", "time", "type"), place)
        time = table.get("time", content.get("time"))
        stamps = None if time is None else stamps_of(str(time))
        kind = str(table.get("type", "CSV"))
        yield f"/{name.strip('/')}", _Table(folder / table["file"], kind, stamps, {})


def _expect(table: Mapping[str, Any], known: Sequence[str], place: Path) -> None:
    for key in table:
        if key not in known:
            meant = did_you_mean(key, known, f"there are {', '.join(known)}")
            raise TraceError(f"{place}: no key `{key}`: {meant}")


@contextmanager
def _lines(table: _Table) -> Iterator[Iterator[tuple[int, list[str]]]]:
    """Open a file as an iterator of line numbers and rows; errors inside name the file."""
    with (
        named_errors(table.path),
        opened_as_csv(table.path, table.stamps) as (plain, _),
        TextIOWrapper(plain, encoding="utf-8-sig", newline="") as text,
    ):
        yield _ended(CopiedLines(bounded_lines(text)))


def _ended(copied: CopiedLines) -> Iterator[tuple[int, list[str]]]:
    """Yield line numbers and rows.

    Raises:
        TraceError: the last line has no end, so that the file may have been cut off in it.
    """
    for line, row in split_lines(copied):
        if not copied.taken().endswith(("\n", "\r")):
            raise TraceError(f"line {line}: it has no end: was it cut off? If not, end the line")
        yield line, row


def _header(table: _Table, rows: Iterator[tuple[int, list[str]]]) -> tuple[Sequence[str], Stamps]:
    _, header = next(rows, (0, []))
    layout = read_layout(header, Schema({}, {}, stamps=table.stamps))
    return layout.header, layout.stamps


def _with_kinds(table: _Table) -> _Table:
    with _lines(table) as rows:
        header, stamps = _header(table, rows)
        cells: dict[str, list[str]] = {name: [] for name in header}
        for _, row in islice(rows, _LOOKED_AT):
            for name, cell in zip(header, row, strict=False):
                if cell:
                    cells[name].append(cell)
        kinds = {
            name: _kinds(own)
            for name, own in cells.items()
            if name != stamps.column and _PATH.fullmatch(name)
        }
    return replace(table, kinds=kinds)


def _kinds(cells: Sequence[str]) -> Sequence[Kind]:
    """The possible kinds of a column, the most likely one first."""
    if not cells:
        return (Kind.REAL, *Kind)
    if all(_WHOLE.fullmatch(cell) for cell in cells):
        return (Kind.INT, Kind.BOOL) if {*cells} <= {"0", "1"} else (Kind.INT,)
    if all(cell in TRUE_WORDS or cell in FALSE_WORDS for cell in cells):
        return (Kind.BOOL,)
    return (Kind.REAL if all(_number(cell) is not None for cell in cells) else Kind.LABEL,)


def _number(cell: str) -> float | None:
    try:
        return int(cell) if _WHOLE.fullmatch(cell) else double_of(cell.replace("_", "?"))
    except TraceError:  # the number is too large
        raise
    except ValueError:
        return None


def _leaf(column: str) -> str:
    """The path of the field of a column; column `q[0]` is an element of the array `q[]`."""
    return re.sub(r"\[\d+\]$", "[]", column)


def _fault(columns: Collection[str]) -> str:
    """The fault of a table in which one column would be inside another, as `q[0]` in `q`; or ""."""
    for column in columns:
        above = column.partition("[")[0] if "[" in column else column.rpartition(".")[0]
        while above:
            if above in columns:
                return f"of its columns `{column}` is in `{above}`: rename one"
            above = above.rpartition(".")[0]
    return ""


def _rows(name: str, table: _Table) -> Iterator[Message]:
    """Yield the rows of a file as messages; a message lacks the fields of empty cells.

    Raises:
        TraceError: with file and line: a row is malformed, or time goes backwards.
    """
    with _lines(table) as rows:
        header, stamps = _header(table, rows)
        time = header.index(stamps.column)
        places = []
        for place, column in enumerate(header):
            if column in table.kinds:
                path, _, index = column.removesuffix("]").partition("[")
                at = int(index) if index else None
                places.append((place, path.split("."), at, table.kinds[column][0]))
        last: int | None = None
        for line, row in rows:
            if len(row) != len(header):
                raise TraceError(f"line {line}: {len(row)} cells, and the header has {len(header)}")
            try:
                t = ticks_of_cell(row[time], stamps)
            except TraceError as error:
                raise TraceError(f"line {line}: {error}") from None
            if last is not None and t < last:
                back = f"from {format_ticks(last)} to {format_ticks(t)}"
                raise TraceError(f"line {line}: time goes backwards, {back}: sort the file by time")
            last = t
            content: dict[str, Any] = {}
            for place, steps, element, kind in places:
                if row[place]:
                    _put(content, steps, element, _value(row[place], kind))
            yield name, t, content


def _put(content: dict[str, Any], steps: Sequence[str], element: int | None, value: Any) -> None:
    inner = content
    for step in steps[:-1]:
        inner = inner.setdefault(step, {})
    if element is None:
        inner[steps[-1]] = value
        return
    array: list[Any] = inner.setdefault(steps[-1], [])
    array += [math.nan] * (element + 1 - len(array))  # elements without a cell are NaN
    array[element] = value


def _value(cell: str, kind: Kind) -> Any:
    if kind is Kind.BOOL and (cell in TRUE_WORDS or cell in FALSE_WORDS):
        return cell in TRUE_WORDS
    number = None if kind is Kind.LABEL else _number(cell)
    return cell if number is None else number
