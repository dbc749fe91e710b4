"""Rich's console for texts that hold names of others."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from rvmon.diagnostics.shown import shown


class Terminal(Console):
    """A console to which no text is an escape, markup or the name of an emoji."""

    def __init__(self, **options: Any) -> None:
        super().__init__(highlight=False, markup=False, emoji=False, **options)

    def render_str(self, text: str, **how: Any) -> Text:
        """The text as it will be shown, so that cells of tables are as wide as that."""
        return super().render_str(shown(text), **how)

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Rich's segments, those of text as they are shown."""
        how = options or self.options
        if isinstance(renderable, Text) and _fits(renderable, how):
            segments = renderable.render(self, end=renderable.end)
        else:
            segments = super().render(renderable, options)
        for segment in segments:
            text = segment.text if segment.control else shown(segment.text)
            yield segment if text is segment.text else Segment(text, segment.style)


def _fits(text: Text, options: ConsoleOptions) -> bool:
    """Whether no line of a text has to be folded, cut or moved: looking for that takes its time."""
    plain, justify = text.plain, text.justify or options.justify or "left"
    if justify not in ("default", "left") or "\t" in plain or (text.style and not text.spans):
        return False
    width = options.max_width
    return all(len(line) * 2 <= width or cell_len(line) <= width for line in plain.split("\n"))
