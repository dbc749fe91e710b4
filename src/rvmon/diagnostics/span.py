"""Places in source text."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Source:
    """One text with the name people know it by (a path, or `<string>`)."""

    name: str
    text: str = field(repr=False)


@dataclass(frozen=True, slots=True)
class Span:
    """The half-open range of characters `[start, end)` of a source.

    Attributes:
        source: the text that the offsets index.
        start: offset of the first character, from 0.
        end: offset behind the last character.
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
        """The range from the start of this span to the end of `other`."""
        return Span(self.source, min(self.start, other.start), max(self.end, other.end))
