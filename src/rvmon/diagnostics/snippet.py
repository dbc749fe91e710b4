"""A place in a text as people like to see it: file, line, and an underline."""

from __future__ import annotations

import unicodedata

from rvmon.diagnostics.shown import shown_line
from rvmon.diagnostics.span import Span

WIDEST = 107
"""A snippet is so many columns wide at most: longer lines are cut around the place."""

_GUTTER = 5


def snippet(
    span: Span, remark: str = "", *, arrow: str = "-->", mark: str = "^", width: int = WIDEST
) -> str:
    """The line of a place with the place underlined.

    Args:
        span: the place; of one that spans lines, the part on its first line is underlined.
        remark: stands behind the underline.
        arrow: leads to the file's name; other places of the same finding take `:::`.
        mark: the character to underline with.
        width: columns that there are, so that underlines stay below what they mean.

    >>> from rvmon.diagnostics.span import Source
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
    underline = " " * _width(head) + mark * max(_width(body), 1)
    return "\n".join(
        (
            f"{gutter}{arrow} {shown_line(span.source.name)}:{number}:{span.column}",
            f"{gutter} |",
            f"{number:>{digits}} | {head}{body}{tail}".rstrip(),
            f"{gutter} | {underline}{' ' + shown_line(remark) if remark else ''}",
        )
    )


def _shown(text: str) -> str:
    return shown_line(text.rstrip("\r").replace("\t", " "))


def _width(text: str) -> int:
    """Columns that a terminal gives to a text."""
    return sum(
        0 if unicodedata.combining(char) else 2 if unicodedata.east_asian_width(char) in "WF" else 1
        for char in text
    )
