"""A document as an editor counts in it: lines, and units of an encoding within them."""

from __future__ import annotations

import re
from bisect import bisect_right

from lsprotocol.types import (
    Position,
    PositionEncodingKind,
    Range,
    TextDocumentContentChangeEvent,
    TextDocumentContentChangePartial,
)

_WIDTHS = {
    PositionEncodingKind.Utf8: (0x80, 0x800, 0x10000),
    PositionEncodingKind.Utf16: (0x10000,),
    PositionEncodingKind.Utf32: (),
}
"""The characters from which on one takes a unit more."""


class Text:
    """A text with its lines; pygls would end them at a form feed or U+2028, which no editor does.

    Args:
        raw: as the editor has it.
        encoding: in whose units columns are counted.

    Source: Language Server Protocol 3.17, Text Documents and Position.
    """

    def __init__(self, raw: str, encoding: str = PositionEncodingKind.Utf16) -> None:
        self.raw = raw
        self.encoding = encoding
        self._widths = _WIDTHS[PositionEncodingKind(encoding)]
        self._starts = [0, *(end.end() for end in re.finditer(r"\r\n|\r|\n", raw))]

    @property
    def code(self) -> str:
        """What is compiled: every line ends as the language has it, all offsets stay."""
        return self.raw.replace("\r\n", " \n").replace("\r", "\n")

    def position(self, offset: int) -> Position:
        r"""Where a character is.

        >>> Text("# 😋\nspec a").position(3).character
        4
        """
        line = bisect_right(self._starts, offset) - 1
        column = sum(map(self._width, self.raw[self._starts[line] : offset]))
        return Position(line, column)

    def range(self, start: int, end: int) -> Range:
        """Where some characters are."""
        return Range(self.position(start), self.position(end))

    def offset(self, position: Position) -> int:
        """The character at a position, at the end of its line at most."""
        if position.line >= len(self._starts):
            return len(self.raw)
        place = self._starts[position.line]
        units = 0
        for char in self.raw[place : place + position.character]:
            units += self._width(char)
            if units > position.character or char in "\r\n":
                break
            place += 1
        return place

    def changed(self, change: TextDocumentContentChangeEvent) -> Text:
        """The text after an edit."""
        if not isinstance(change, TextDocumentContentChangePartial):
            return Text(change.text, self.encoding)
        start, end = self.offset(change.range.start), self.offset(change.range.end)
        return Text(self.raw[:start] + change.text + self.raw[end:], self.encoding)

    def _width(self, char: str) -> int:
        return 1 + bisect_right(self._widths, ord(char))
