"""CSV dialects of other tools: detected by the first lines, and converted to plain CSV."""

from __future__ import annotations

import csv
import io
import re
import shlex
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
from rvmon.recordings.csv_text import line_ends, native_csv
from rvmon.recordings.places import opened
from rvmon.texts import shorten
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import DEFAULT_COLUMNS, UNITS, stamps_of
from rvmon.units import UnknownUnitError, parse_unit

_LOOKED_AT = 1 << 13  # bytes at the start that decide on the dialect
_MOST_ABOVE = 30  # a header is among this many lines

_SOME, _TOGETHER = 10, 4096
"""Rows after a header that are compared with it; lines that are converted at once."""

_SEPARATORS: tuple[str, ...] = (",", ";", "\t", "|", "")
"""The separators of cells; "" stands for blanks, any number of them."""

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?(nan|inf)", re.I | re.ASCII)
_COMMA = re.compile(r"([+-]?\d*),(\d+([eE][+-]?\d+)?)", re.ASCII)
_POINT = re.compile(r"[+-]?\d*\.\d+([eE][+-]?\d+)?", re.ASCII)
_COMMENT = re.compile(r"\s*(#|//|%(?!time\b))\s*")
_SEPARATOR_LINE = re.compile(r'"?sep=(.)"?\s*', re.IGNORECASE)
_UNIT_IN_NAME = re.compile(r"(?P<name>.*?\S)\s*(\[(?P<unit>[^\[\]]*)\]|\((?P<same>[^()]*)\))")

_PARTS = {"ns": 1, "nsec": 1, "nsecs": 1, "nanosec": 1, "nanosecs": 1, "nanoseconds": 1}
_PARTS |= {"us": 1_000, "usec": 1_000, "microseconds": 1_000, "ms": 1_000_000, "msec": 1_000_000}
"""The unit of the second of two stamp columns, in nanoseconds, by the last word of its name."""


class Dialect(Struct, frozen=True):
    """How a CSV text is written."""

    separator: str = ","  # between cells; "": blanks
    above: int = 0  # lines above the header
    is_commented: bool = False  # whether the header is a comment, the last one above the rows
    has_commas: bool = False  # whether numbers have decimal commas
    encoding: str = "utf-8-sig"


PLAIN = Dialect()


@contextmanager
def opened_as_csv(path: str | Path, stamps: Stamps | None) -> Iterator[tuple[BinaryIO, BinaryIO]]:
    """Open a file as plain CSV, together with the raw file; see `opened`.

    Lines keep their numbers. A stamp in two columns, `sec+nanosec`, or one with a pattern becomes
    one plain column.
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
    """A binary file of the given lines."""

    def __init__(self, lines: Iterator[str]) -> None:
        self._lines = lines
        self._rest = b""

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any, /) -> int:
        """Fill the buffer with the next bytes; return their number, 0 at the end."""
        parts, size = [self._rest], len(self._rest)
        while size < len(buffer) and (line := next(self._lines, None)) is not None:
            parts.append(line.encode())
            size += len(parts[-1])
        found, count = b"".join(parts), min(len(buffer), size)
        buffer[:count], self._rest = found[:count], found[count:]
        return count


def dialect_of(head: bytes) -> Dialect:
    r"""The dialect of a text with this start; plain CSV if no table is recognised.

    >>> dialect_of(b"# by a tool\nt;v\n0;1,5\n")
    Dialect(separator=';', above=1, is_commented=False, has_commas=True, encoding='utf-8-sig')
    """
    is_wide = head.startswith((b"\xff\xfe", b"\xfe\xff"))
    encoding = "utf-16" if is_wide else PLAIN.encoding
    text = head.decode(encoding, "replace")
    header = text.partition("\n")[0].splitlines()
    if header and any(cell.strip(' "') in DEFAULT_COLUMNS for cell in header[0].split(",")[:-1]):
        # This is our own header; oddities below it are reported when they are read.
        return structs.replace(PLAIN, encoding=encoding) if is_wide else PLAIN
    lines = text.splitlines()
    if len(head) == _LOOKED_AT:
        lines = lines[:-1]
    above, separators = 0, _SEPARATORS
    if lines and (stated := _SEPARATOR_LINE.fullmatch(lines[0])):
        above, separators = 1, (stated[1],)
    for first in range(above, min(len(lines), _MOST_ABOVE)):
        if not lines[first].strip() or _COMMENT.match(lines[first]):
            continue
        for separator in separators:
            found = _dialect_at(lines, first, separator)
            if found is not None:
                return structs.replace(found, encoding=encoding)
    return structs.replace(PLAIN, encoding=encoding) if is_wide else PLAIN


def _dialect_at(lines: Sequence[str], first: int, separator: str) -> Dialect | None:
    """The dialect of a table whose header, or first row, is line `first`; `None`: there is none."""
    if not separator and any(other in lines[first] for other in _SEPARATORS if other):
        return None  # the blanks are inside cells
    header = _cells(lines[first], separator)
    following = [line for line in lines[first + 1 :] if line.strip() and not _COMMENT.match(line)]
    rows = [_cells(line, separator) for line in following[:_SOME]]
    # Half of the rows suffices: ragged rows are reported when they are read.
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
    """Yield the text converted to plain CSV; lines of comments become empty lines.

    The last line has an end if it has one in the text. Lines are converted many at a time as long
    as none of them needs a closer look.
    """
    made: Callable[[list[str]], list[str]] | None = None
    written: list[str] = []
    # So that it quotes lone carriage returns, too.
    writer = csv.writer(SimpleNamespace(write=written.append), lineterminator="\r\n")
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
        plain = written.pop().removesuffix("\r\n")
        ends = line_ends(plain) + 1
        # The header is moved to the first line; all other lines keep their numbers.
        missing = number - lines - ends if lines else 0
        lines += missing + ends
        yield "\n" * missing + plain + "\n" * source.is_ended
        # Convert in bulk as long as possible; where that fails, go on row by row for a while.
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
    """An iterator of lines with lookahead."""

    def __init__(self, lines: Iterator[str]) -> None:
        self._lines = lines
        self._seen: deque[str] = deque()
        self.is_ended = True  # whether the line taken last by `next` has an end

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line = self._seen.popleft() if self._seen else next(self._lines)
        self.is_ended = line.endswith(("\n", "\r"))
        return line

    def ahead(self) -> Sequence[str]:
        """Up to `_TOGETHER` of the next lines, which are not taken yet."""
        self._seen += islice(self._lines, _TOGETHER - len(self._seen))
        return tuple(self._seen)

    def take(self) -> None:
        """Take the lines that `ahead` gave."""
        self._seen.clear()


def _as_plain(lines: Sequence[str], dialect: Dialect) -> str | None:
    """Convert some lines to plain CSV; `None`: they must be converted one by one."""
    separator, text = dialect.separator, "".join(lines)
    # Look for the signs first, as the pattern takes long.
    if dialect.above and any(sign in text for sign in "#/%") and _COMMENT.search(text):
        return None
    plain = None
    if separator.isascii():
        plain = native_csv.as_plain(text.encode(), ord(separator), dialect.has_commas)
    return _rewritten(lines, dialect) if plain is None else plain.decode()


def _rewritten(lines: Sequence[str], dialect: Dialect) -> str | None:
    """Convert lines by splitting and rewriting them; `None` if a row is not one line each."""
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
    """Yield the header and rows with their line numbers; comments and blank lines are skipped."""
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
        # Below the header, `#` starts a comment only in a file with lines above its header.
        is_comment = above and (number > above + 1) and row and _COMMENT.match(row[0])
        if not is_comment and any(row):
            yield number, row


def _stamp_maker(
    header: list[str], stamps: Stamps | None
) -> tuple[list[str], Callable[[list[str]], list[str]]]:
    """A header with a column for the stamp that is made, and the function that converts a row.

    The stamp is made of two columns or by a pattern; else header and rows stay as they are. If the
    last cell of a row is a part of the stamp, the stamp is put last, because a file that was cut
    off may have lost the end of this cell.
    """
    if stamps is None or not ("+" in stamps.column or stamps.pattern):
        return header, _unchanged
    parts = [stamps.column] if stamps.column in header else stamps.column.split("+")
    missing = [part for part in parts if part not in header]
    if missing or (not stamps.pattern and len(parts) != 2):
        return header, _unchanged  # `stamps_among` reports the missing column
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
    """Split the name of a column into the bare name and the unit after it in brackets, or "".

    >>> name_and_unit("speed [m/s]"), name_and_unit("mode")
    (('speed', 'm/s'), ('mode', ''))
    """
    found = _UNIT_IN_NAME.fullmatch(column)
    return (column, "") if found is None else (found["name"], found["unit"] or found["same"] or "")


def bare_names(header: Sequence[str], schema: Schema) -> tuple[list[str], Schema]:
    """Remove units from the names in a header where the bare name is declared, or is the time.

    A unit of the time column becomes that of the schema's stamps.

    Raises:
        TraceError: the unit of a column is not that of its declaration.
    """
    declared = {*schema.signals, *schema.events}
    declared |= {f"{name}.{field}" for name, own in schema.events.items() for field in own}
    aliases = schema.aliases
    written = frozenset(header)
    names: list[str] = []
    for column in header:
        bare, unit = name_and_unit(column)
        name = aliases.get(column, bare)
        if name in declared and (column in aliases or name not in written):
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
    """Check the unit in the name of a column against the declared one.

    A text that is not a known unit is accepted only if the user has mapped the column.
    """
    declared = schema.units.get(name, "")
    try:
        there, wanted = parse_unit(unit), parse_unit(declared)
    except UnknownUnitError:
        if not declared or column in schema.aliases:
            return
        given = shlex.quote(f"{name}={column}")
        raise TraceError(
            f"column `{shorten(column)}`: `{shorten(unit)}` is not a known unit, and `{name}` is "
            f"declared [{declared}]: if the column is in [{declared}], say so: --map {given}, in "
            "Python columns=…"
        ) from None
    if declared and unit and (there.dimension, there.factor) != (wanted.dimension, wanted.factor):
        raise TraceError(
            f"column `{shorten(column)}` is in [{unit}], and `{name}` is declared [{declared}]: "
            f"declare it in [{unit}], or convert the column"
        )
