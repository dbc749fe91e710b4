"""Terminal output: a console that is safe for foreign text, plain tables, wrapped sentences."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from rvmon.texts import shown


class Terminal(Console):
    """A console that never interprets text as an escape sequence, markup or emoji name."""

    def __init__(self, **options: Any) -> None:
        super().__init__(highlight=False, markup=False, emoji=False, **options)

    def render_str(self, text: str, **how: Any) -> Text:
        """The text as it will be shown, so that table cells are measured by it."""
        return super().render_str(shown(text), **how)

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Rich's segments, with unsafe characters of their text escaped."""
        for segment in super().render(renderable, options):
            text = segment.text if segment.control else shown(segment.text)
            yield segment if text is segment.text else Segment(text, segment.style)


def plain_table(rows: Sequence[Sequence[str]]) -> str:
    """A line per row, columns aligned.

    Args:
        rows: the first one is the head; all of one length.

    >>> print(plain_table([("", "verdict"), ("R1", "P")]), end="")
        verdict
    R1  P
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = (
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )
    return "\n".join(lines) + "\n"


_WITHIN_VALUE = re.compile(r"(?<=\d) (?=[A-Za-zµ°%])|(?<=\w) (?== )|(?<= =) ")
_TOGETHER = "\N{NO-BREAK SPACE}"


def wrapped(sentence: str, width: int) -> str:
    """A sentence in lines, the first indented by two columns, the others by four.

    A number is kept on one line with its unit, and with `name =` before it.

    Args:
        sentence: without line breaks.
        width: columns that a line may take.

    >>> print(wrapped("`released` occurred at 4.75 s, 0.75 s after the trigger", 32))
      `released` occurred at 4.75 s,
        0.75 s after the trigger
    """
    whole = _WITHIN_VALUE.sub(_TOGETHER, sentence)
    lines = textwrap.fill(
        whole,
        width,
        initial_indent="  ",
        subsequent_indent="    ",
        break_on_hyphens=False,
    )
    return lines.replace(_TOGETHER, " ")


def in_short(message: str) -> str:
    r"""The first line of a message, with the second one if it ends in a colon.

    >>> in_short("there is no column for what is read:\n  `go`, read by R1\n  say which it is")
    'there is no column for what is read: `go`, read by R1'
    """
    first, *rest = message.split("\n")
    return f"{first} {rest[0].strip()}" if rest and first.endswith(":") else first
