"""Terminal output: a console of rich that is safe for foreign text, plain tables."""

from __future__ import annotations

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
            # Control segments are cursor moves of rich; foreign text never becomes one.
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
