"""CSV as other tools write it: found out by its first lines, and read as if it were plain."""

from __future__ import annotations

import csv
import io
import re
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from itertools import islice
from pathlib import Path
from types import SimpleNamespace
from typing import Any, BinaryIO

from msgspec import Struct, structs

from rvmon.errors import TraceError
from rvmon.recordings.csv_rows import split_lines
from rvmon.recordings.csv_text import native_csv
from rvmon.recordings.places import opened
from rvmon.texts import shorten
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import DEFAULT_COLUMNS, UNITS, stamps_of
from rvmon.units import UnknownUnitError, parse_unit

_LOOKED_AT = 1 << 13  # bytes that say how a text is written
_MOST_ABOVE = 30  # lines above a header, at most

_SOME, _TOGETHER = 10, 4096
"""Rows that have to agree; lines that are taken at once."""

_SEPARATORS: tuple[str, ...] = (",", ";", "\t", "|", "")
"""The empty one stands for blanks, as many as there are."""

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?(nan|inf)", re.I | re.ASCII)
_COMMA = re.compile(r"([+-]?\d*),(\d+([eE][+-]?\d+)?)", re.ASCII)
_POINT = re.compile(r"[+-]?\d*\.\d+([eE][+-]?\d+)?", re.ASCII)
_COMMENT = re.compile(r"\s*(#|//|%(?!time\b))\s*")
_SEPARATOR_SAID = re.compile(r'"?sep=(.)"?\s*', re.IGNORECASE)
_UNIT_IN_NAME = re.compile(r"(?P<name>.*?\S)\s*(\[(?P<unit>[^\[\]]*)\]|\((?P<same>[^()]*)\))")

_PARTS = {"ns": 1, "nsec": 1, "nsecs": 1, "nanosec": 1, "nanosecs": 1, "nanoseconds": 1}
_PARTS |= {"us": 1_000, "usec": 1_000, "microseconds": 1_000, "ms": 1_000_000, "msec": 1_000_000}
"""Nanoseconds by what the second of two columns of a stamp is called."""


class Dialect(Struct, frozen=True):
    """The dialect of a text."""

    separator: str = ","  # of cells; empty: blanks
    above: int = 0  # lines above the header
    is_commented: bool = False  # whether the header is the last of those that are comments
    has_commas: bool = False  # whether numbers have a comma where plain ones have a point
    encoding: str = "utf-8-sig"  # of the text


PLAIN = Dialect()


@contextmanager
def opened_as_csv(path: str | Path, stamps: Stamps | None) -> Iterator[tuple[BinaryIO, BinaryIO]]:
    """The text of a file as plain CSV, and the file as it lies there; see `opened`.

    Lines keep their numbers. A stamp that two columns give, `sec+nanosec`, becomes a column.
    """
    with opened(path) as (plain, raw):
        head = plain.peek(_LOOKED_AT)[:_LOOKED_AT]  # type: ignore[attr-defined]  # it is buffered
        dialect = dialect_of(head)
        is_made = stamps is not None and ("+" in stamps.column or bool(stamps.pattern))
        if dialect == PLAIN and not is_made:
            yield plain, raw
            return
        with (
            io.TextIOWrapper(plain, encoding=dialect.encoding, newline="") as text,
            io.BufferedReader(_Converted(_plain_lines(text, dialect, stamps))) as converted,
        ):
            yield converted, raw


class _Converted(io.RawIOBase):
    """Lines as bytes."""

    def __init__(self, lines: Iterator[str]) -> None:
        self._lines = lines
        self._rest = b""

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any, /) -> int:
        """Fill the buffer with what comes next; 0 at the end."""
        parts, size = [self._rest], len(self._rest)
        while size < len(buffer) and (line := next(self._lines, None)) is not None:
            parts.append(line.encode())
            size += len(parts[-1])
        found, count = b"".join(parts), min(len(buffer), size)
        buffer[:count], self._rest = found[:count], found[count:]
        return count


def dialect_of(head: bytes) -> Dialect:
    r"""How a text is written that begins so; what is like nothing is plain.

    >>> dialect_of(b"# by a tool\nt;v\n0;1,5\n")
    Dialect(separator=';', above=1, is_commented=False, has_commas=True, encoding='utf-8-sig')
    """
    is_wide = head.startswith((b"\xff\xfe", b"\xfe\xff"))
    encoding = "utf-16" if is_wide else PLAIN.encoding
    text = head.decode(encoding, "replace")
    header = text.partition("\n")[0].splitlines()
    if header and any(cell.strip(' "') in DEFAULT_COLUMNS for cell in header[0].split(",")[:-1]):
        # What is odd is told later.
        return structs.replace(PLAIN, encoding=encoding) if is_wide else PLAIN
    lines = text.splitlines()
    if len(head) == _LOOKED_AT:
        lines = lines[:-1]
    above, separators = 0, _SEPARATORS
    if lines and (said := _SEPARATOR_SAID.fullmatch(lines[0])):
        above, separators = 1, (said[1],)
    for first in range(above, min(len(lines), _MOST_ABOVE)):
        if not lines[first].strip() or _COMMENT.match(lines[first]):
            continue
        for separator in separators:
            found = _dialect_at(lines, first, separator)
            if found is not None:
                return structs.replace(found, encoding=encoding)
    return structs.replace(PLAIN, encoding=encoding) if is_wide else PLAIN


def _dialect_at(lines: Sequence[str], first: int, separator: str) -> Dialect | None:
    """The dialect of a table whose header, or first row, is that line; `None`: there is none."""
    if not separator and any(other in lines[first] for other in _SEPARATORS if other):
        return None  # blanks within cells
    header = _cells(lines[first], separator)
    behind = [line for line in lines[first + 1 :] if line.strip() and not _COMMENT.match(line)]
    rows = [_cells(line, separator) for line in behind[:_SOME]]
    # Rows that are ragged are told where they are read.
    alike = sum(len(row) == len(header) for row in rows)
    if len(header) < 2 or 2 * alike < len(rows):
        return None
    numbers = sum(bool(_NUMBER.fullmatch(cell.strip())) for cell in header)
    if numbers == len(header):
        above = lines[first - 1] if first else ""
        commented = _cells(_COMMENT.sub("", above, count=1), separator)
        if not _COMMENT.match(above) or len(commented) != len(header):
            return None
        return Dialect(separator, first - 1, True, _has_commas([header, *rows], separator))
    if first and (numbers or not rows):
        return None
    return Dialect(separator, first, False, _has_commas(rows, separator))


def _has_commas(rows: Sequence[Sequence[str]], separator: str) -> bool:
    cells = [cell.strip() for row in rows for cell in row]
    return separator != "," and (
        any(_COMMA.fullmatch(cell) for cell in cells)
        and not any(_POINT.fullmatch(cell) for cell in cells)
    )


def _cells(line: str, separator: str) -> list[str]:
    if not separator:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator), [])
    except csv.Error:
        return []


def _plain_lines(text: io.TextIOWrapper, dialect: Dialect, stamps: Stamps | None) -> Iterator[str]:
    """The lines of a text as plain CSV has them; where comments stood they are empty.

    The last one has an end if it has one in the text. As long as no line needs a closer look,
    many are taken at once.
    """
    made: Callable[[list[str]], list[str]] | None = None
    written: list[str] = []
    writer = csv.writer(SimpleNamespace(write=written.append), lineterminator="\n")
    lines = taken = again = 0
    source = _Lines(text)
    for counted, row in _rows(source, dialect):
        number = counted + taken
        if made is None:
            row, made = _stamp_maker(row, stamps)
        else:
            if dialect.has_commas:
                row = [_with_point(one) if "," in one else one for one in row]
            try:
                row = made(row)
            except TraceError as error:
                raise TraceError(f"line {number}: {error}") from None
        writer.writerow(row)
        plain = written.pop()
        # The header comes first, whatever stood above it; the others keep their numbers.
        missing = number - lines - plain.count("\n") if lines else 0
        lines += missing + plain.count("\n")
        yield "\n" * missing + (plain if source.is_ended else plain[:-1])
        if number >= again and made is _unchanged and dialect.separator:
            yield "\n" * (number - lines)
            lines = number
            while (many := source.ahead()) and (found := _as_plain(many, dialect)):
                source.take()
                taken += len(many)
                lines += len(many)
                yield found
            again = lines + _TOGETHER


class _Lines:
    """Lines, of which some are looked at before they are taken."""

    def __init__(self, lines: Iterator[str]) -> None:
        self._lines = lines
        self._seen: deque[str] = deque()
        self.is_ended = True  # whether the last one has its end that was taken by itself

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line = self._seen.popleft() if self._seen else next(self._lines)
        self.is_ended = line.endswith(("\n", "\r"))
        return line

    def ahead(self) -> Sequence[str]:
        """Some of the next lines."""
        self._seen += islice(self._lines, _TOGETHER - len(self._seen))
        return tuple(self._seen)

    def take(self) -> None:
        """Take those that were looked at."""
        self._seen.clear()


def _as_plain(lines: Sequence[str], dialect: Dialect) -> str | None:
    """Some lines as plain CSV has them; `None`: one has to be looked at by itself."""
    separator, text = dialect.separator, "".join(lines)
    # The signs are sought first, as the pattern takes long.
    if dialect.above and any(sign in text for sign in "#/%") and _COMMENT.search(text):
        return None
    plain = None
    if separator.isascii():
        plain = native_csv.as_plain(text.encode(), ord(separator), dialect.has_commas)
    return _rewritten(lines, dialect) if plain is None else plain.decode()


def _rewritten(lines: Sequence[str], dialect: Dialect) -> str | None:
    """The same where each line is a row, split and written again."""
    split = csv.reader(lines, delimiter=dialect.separator, strict=True)
    written = io.StringIO()
    writer = csv.writer(written, lineterminator="\n")
    try:
        rows = [[*map(str.strip, row)] for row in split]
        if dialect.has_commas:
            rows = [[_with_point(one) if "," in one else one for one in row] for row in rows]
        writer.writerows(row if any(row) else () for row in rows)
    except csv.Error:
        return None
    found = written.getvalue()
    return (found if lines[-1][-1] in "\r\n" else found[:-1]) if len(rows) == len(lines) else None


def _unchanged(row: list[str]) -> list[str]:
    return row


def _with_point(cell: str) -> str:
    return cell.replace(",", ".") if _COMMA.fullmatch(cell) else cell


def _rows(lines: Iterator[str], dialect: Dialect) -> Iterator[tuple[int, list[str]]]:
    """The rows with the numbers of their lines; what is no row is left out."""
    above = dialect.above
    for _ in range(above):
        next(lines, "")
    if dialect.is_commented:
        above += 1
        yield above, _cells(_COMMENT.sub("", next(lines, ""), count=1), dialect.separator)
    if dialect.separator:
        rows = split_lines(lines, above, dialect.separator)
    else:
        rows = ((number, line.split()) for number, line in enumerate(lines, above + 1))
    for number, row in rows:
        # What begins so is a comment where there were some above the header.
        is_comment = above and (number > above + 1) and row and _COMMENT.match(row[0])
        if not is_comment and any(row):
            yield number, row


def _stamp_maker(
    header: list[str], stamps: Stamps | None
) -> tuple[list[str], Callable[[list[str]], list[str]]]:
    """A header, and what makes rows of it, with the stamp that several columns, or a pattern, give.

    What stands last in a row stands last there, too: it may be half of what it was.
    """
    if stamps is None or not ("+" in stamps.column or stamps.pattern):
        return header, _unchanged
    parts = [stamps.column] if stamps.column in header else stamps.column.split("+")
    missing = [part for part in parts if part not in header]
    if missing or (not stamps.pattern and len(parts) != 2):
        return header, _unchanged  # whoever looks for the column says that it is missing
    places = [header.index(part) for part in parts]
    is_last = len(header) - 1 in places

    def put(row: Sequence[str], stamp: str) -> list[str]:
        kept = [cell for name, cell in zip(header, row, strict=True) if name != stamps.column]
        return [*kept, stamp] if is_last else [stamp, *kept]

    def made(row: list[str]) -> list[str]:
        if len(row) != len(header):
            return row
        return put(row, _stamp([row[place] for place in places], parts, stamps))

    return put(header, stamps.column), made


def _stamp(cells: Sequence[str], parts: Sequence[str], stamps: Stamps) -> str:
    text = " ".join(cells)
    try:
        if stamps.pattern:
            found = datetime.strptime(text, stamps.pattern)
            return found.isoformat()
        scale = _PARTS.get(re.split(r"[._\s]", parts[1])[-1].lower(), 1)
        return str(int(cells[0]) * 1_000_000_000 + int(cells[1]) * scale)
    except ValueError:
        form = f"a date like `{stamps.pattern}`" if stamps.pattern else "two whole numbers"
        raise TraceError(f"time `{shorten(text)}` is not {form}") from None


def name_and_unit(column: str) -> tuple[str, str]:
    """A name without the unit that stands behind it in brackets, and that.

    >>> name_and_unit("speed [m/s]"), name_and_unit("mode")
    (('speed', 'm/s'), ('mode', ''))
    """
    found = _UNIT_IN_NAME.fullmatch(column)
    return (column, "") if found is None else (found["name"], found["unit"] or found["same"] or "")


def bare_names(header: Sequence[str], schema: Schema) -> tuple[list[str], Schema]:
    """A header without the units that stand in it, where what is left is a name that is read."""
    declared = {*schema.signals, *schema.events}
    declared |= {f"{name}.{field}" for name, own in schema.events.items() for field in own}
    aliases = schema.aliases
    written = frozenset(header)
    names: list[str] = []
    for column in header:
        bare, unit = name_and_unit(column)
        name = aliases.get(column, bare)
        if name in declared:
            _expect_unit(column, name, unit, schema)
        is_time = schema.stamps is None and name in DEFAULT_COLUMNS
        if column in aliases or name in written or not (name in declared or is_time):
            names.append(column)
            continue
        names.append(name)
        if is_time and unit in UNITS:
            schema = replace(schema, stamps=stamps_of(f"{name}:{unit}"))
    return names, schema


def _expect_unit(column: str, name: str, unit: str, schema: Schema) -> None:
    """See that the unit in the name of a column is the declared one, as far as both are units."""
    declared = schema.units.get(name, "")
    try:
        there, wanted = parse_unit(unit), parse_unit(declared)
    except UnknownUnitError:
        return
    if declared and unit and (there.dimension, there.factor) != (wanted.dimension, wanted.factor):
        raise TraceError(
            f"column `{shorten(column)}` is in [{unit}], and `{name}` is declared [{declared}]: "
            f"declare it in [{unit}], or convert the column"
        )
