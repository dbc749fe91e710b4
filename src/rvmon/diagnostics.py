"""Diagnostics about a specification or model, and their rendering.

A diagnostic is data with places in the source. It is rendered in full, with colour, for people; on
one line for tools; and as JSON for programs.
"""

from __future__ import annotations

import json
import os
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, TextIO

from rvmon.texts import escaped_line


@dataclass(frozen=True, slots=True)
class Source:
    """A text and the name it has in messages (a path, or `<string>`)."""

    name: str
    text: str = field(repr=False)


@dataclass(frozen=True, slots=True)
class Span:
    """The half-open range of characters `[start, end)` of a source.

    Attributes:
        source: the text that the offsets refer to.
        start: offset of the first character, from 0.
        end: offset after the last character.
    """

    source: Source
    start: int
    end: int

    @property
    def line(self) -> int:
        """Line of the first character, from 1."""
        return self.source.text.count("\n", 0, self.start) + 1

    @property
    def column(self) -> int:
        """Column of the first character, from 1."""
        return self.start - (self.source.text.rfind("\n", 0, self.start) + 1) + 1

    @property
    def text(self) -> str:
        """The characters themselves.

        >>> Span(Source("a.rv", "upon sensed"), 5, 11).text
        'sensed'
        """
        return self.source.text[self.start : self.end]

    def to(self, other: Span) -> Span:
        """The smallest range that contains this span and `other`."""
        return Span(self.source, min(self.start, other.start), max(self.end, other.end))


class Severity(StrEnum):
    """Severity of a diagnostic: an error stops the compilation, a warning does not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Label:
    """A place with an optional remark, which is printed after its underline."""

    span: Span
    text: str = ""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One error or warning.

    Attributes:
        code: stable identifier, such as `RV012`; the documentation has a page for each.
        name: the code in words, such as `unknown-signal`.
        severity: error or warning.
        message: one sentence that says what is wrong.
        spans: the places, the offending one first; empty if the whole file is meant.
        help: a fix; empty if none is known.
    """

    code: str
    name: str
    severity: Severity
    message: str
    spans: tuple[Label, ...] = ()
    help: str = ""


WIDEST = 107
"""The most columns of a snippet; longer lines are cut around the place."""

_GUTTER = 5
"""Columns of line number and `|` at the left of a snippet."""


def snippet(
    span: Span, remark: str = "", *, arrow: str = "-->", mark: str = "^", width: int = WIDEST
) -> str:
    """The source line of a place, with the place underlined.

    Args:
        span: the place; if it spans several lines, only its part on the first is underlined.
        remark: printed after the underline.
        arrow: printed before the file name; further places of the same diagnostic take `:::`.
        mark: the character to underline with.
        width: columns of the terminal; a wrapped line would move the underline off its place.

    >>> from rvmon.diagnostics import Source
    >>> print(snippet(Span(Source("a.rv", "upon sensd"), 5, 10)))
      --> a.rv:1:6
       |
     1 | upon sensd
       |      ^^^^^
    """
    text = span.source.text
    first = text.rfind("\n", 0, span.start) + 1
    stop = text.find("\n", span.start)
    last = len(text) if stop < 0 else stop
    end = min(max(span.end, span.start), last)
    room = max(min(width, WIDEST) - _GUTTER, 10)
    room -= 2 * (last - first > room)  # for the dots
    left = max(first, min(span.start - room * 2 // 5, last - room))
    right = min(last, left + room)
    head = ("…" if left > first else "") + _shown(text[left : span.start])
    body = _shown(text[span.start : min(end, right)])
    tail = _shown(text[min(end, right) : right]) + ("…" if right < last else "")
    number = str(span.line)
    digits = max(len(number), 2)
    gutter = " " * digits
    underline = " " * columns_of(head) + mark * max(columns_of(body), 1)
    return "\n".join(
        (
            f"{gutter}{arrow} {escaped_line(span.source.name)}:{number}:{span.column}",
            f"{gutter} |",
            f"{number:>{digits}} | {head}{body}{tail}".rstrip(),
            f"{gutter} | {underline}{' ' + escaped_line(remark) if remark else ''}",
        )
    )


def _shown(text: str) -> str:
    return escaped_line(text.rstrip("\r").replace("\t", " "))


def columns_of(text: str) -> int:
    """The columns that a text takes in a terminal.

    >>> columns_of("speed"), columns_of("速度")
    (5, 4)
    """
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(char) else 2 if unicodedata.east_asian_width(char) in "WF" else 1
        for char in text
    )


def render_full(diagnostics: Sequence[Diagnostic], width: int = WIDEST) -> str:
    """All diagnostics with their places underlined and their fixes, separated by blank lines."""
    return "\n\n".join(_full(diagnostic, width) for diagnostic in diagnostics)


def render_concise(diagnostics: Sequence[Diagnostic]) -> str:
    """One line per diagnostic: `file:line:column: error[code name]: message (help: …)`."""
    return "\n".join(map(_concise, diagnostics))


def render_json(diagnostics: Sequence[Diagnostic]) -> str:
    """A JSON array, one line per diagnostic; lines and columns count from 1, offsets from 0.

    Each line starts with the first place, so that a regular expression can find it there.
    """
    lines = [json.dumps(_plain(diagnostic)) for diagnostic in diagnostics]
    return "[\n" + ",\n".join(lines) + "\n]" if lines else "[]"


def _full(diagnostic: Diagnostic, width: int) -> str:
    lines = [_heading(diagnostic)]
    for number, label in enumerate(diagnostic.spans):
        arrow, mark = (":::", "-") if number else ("-->", "^")
        lines.append(snippet(label.span, label.text, arrow=arrow, mark=mark, width=width))
    if diagnostic.help:
        lines.append(f"help: {_one_line(diagnostic.help)}")
    return "\n".join(lines)


def _heading(diagnostic: Diagnostic) -> str:
    kind = f"{diagnostic.severity}[{diagnostic.code} {diagnostic.name}]"
    return f"{kind}: {_one_line(diagnostic.message)}"


def _concise(diagnostic: Diagnostic) -> str:
    place = ""
    if diagnostic.spans:
        span = diagnostic.spans[0].span
        place = f"{escaped_line(span.source.name)}:{span.line}:{span.column}: "
    fix = f" (help: {_one_line(diagnostic.help)})" if diagnostic.help else ""
    return f"{place}{_heading(diagnostic)}{fix}"


def _one_line(text: str) -> str:
    return escaped_line(text.replace("\n", " "))


def _plain(diagnostic: Diagnostic) -> dict[str, Any]:
    places = [_place(label) for label in diagnostic.spans]
    first = places[0] if places else None
    return {
        "file": first["file"] if first else "",
        "line": first["start"]["line"] if first else 0,
        "column": first["start"]["column"] if first else 0,
        "severity": str(diagnostic.severity),
        "code": diagnostic.code,
        "name": diagnostic.name,
        "message": _one_line(diagnostic.message),
        "help": _one_line(diagnostic.help),
        "spans": places,
    }


def _place(label: Label) -> dict[str, Any]:
    span = label.span
    return {
        "file": span.source.name,
        "start": _position(span.source, span.start),
        "end": _position(span.source, span.end),
        "text": label.text,
    }


def _position(source: Source, offset: int) -> dict[str, int]:
    point = Span(source, offset, offset)
    return {"line": point.line, "column": point.column, "offset": offset}


RESET, BOLD, BLUE, CYAN = "\x1b[0m", "\x1b[1m", "\x1b[34m", "\x1b[36m"
SEVERITIES = {"error": "\x1b[31m", "warning": "\x1b[33m"}

_HEADING = re.compile(r"(error|warning)(\[[^\]]*\]): (.*)")
_ARROW = re.compile(r"( *(?:-->|:::) )(.*)")
_UNDERLINE = re.compile(r"( +\| +)(\^+|-+)(.*)")


def wants_colour(stream: TextIO) -> bool:
    """Whether to colour: on a terminal, or if `FORCE_COLOR` is set; never if `NO_COLOR` is."""
    if os.environ.get("NO_COLOR"):
        return False
    is_able = stream.isatty() and os.environ.get("TERM") != "dumb"
    return is_able or bool(os.environ.get("FORCE_COLOR"))


def coloured(text: str) -> str:
    r"""The output of `render_full` with severity, places and help in colour.

    >>> coloured("help: did you mean `a`?")
    '\x1b[36mhelp:\x1b[0m did you mean `a`?'
    """
    lines = []
    mark = ""
    for line in text.split("\n"):
        if match := _HEADING.fullmatch(line):
            mark = SEVERITIES[match[1]]
            line = f"{BOLD}{mark}{match[1]}{match[2]}{RESET}{BOLD}: {match[3]}{RESET}"
        elif match := _ARROW.fullmatch(line):
            line = f"{BLUE}{match[1]}{RESET}{match[2]}"
        elif match := _UNDERLINE.fullmatch(line):
            own = mark if match[2][0] == "^" else BLUE
            line = f"{BLUE}{match[1]}{RESET}{own}{match[2]}{match[3]}{RESET}"
        elif line.startswith("help:"):
            line = f"{CYAN}help:{RESET}{line.removeprefix('help:')}"
        lines.append(line)
    return "\n".join(lines)
