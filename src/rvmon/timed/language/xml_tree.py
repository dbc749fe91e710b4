"""XML as a tree in which every character of every text knows its place in the file.

Only what a model needs: elements, attributes, texts. Declarations of entities are refused, nothing
outside the file is ever read, and size and depth are limited.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from rvmon.diagnostics import Source, Span
from rvmon.timed.language.parse import MAX_CHARACTERS
from rvmon.timed.model.rules import model_error

MAX_DEPTH = 20
"""A model's elements are nested no deeper than this."""


@dataclass(slots=True)
class Element:
    """An element with its texts joined, and where each piece of them stands.

    Attributes:
        pieces: of the text, as they were read.
        offsets: of the pieces in `text`.
        places: of the same pieces in the file.
    """

    name: str
    attributes: Mapping[str, str]
    source: Source
    start: int
    children: list[Element] = field(default_factory=list)
    text: str = ""
    pieces: list[str] = field(default_factory=list)
    offsets: list[int] = field(default_factory=list)
    places: list[int] = field(default_factory=list)

    def all(self, name: str) -> Iterator[Element]:
        """The children of a name."""
        return (child for child in self.children if child.name == name)

    def first(self, name: str) -> Element | None:
        """The first child of a name."""
        return next(self.all(name), None)

    def span(self) -> Span:
        """The beginning of the element's tag."""
        return Span(self.source, self.start, self.start + len(self.name) + 1)

    def place(self, start: int, end: int) -> Span:
        """Where some characters of the text stand in the file."""
        if not self.offsets:
            return self.span()
        first = self._position(start)
        return Span(self.source, first, max(first, self._position(end - 1) + 1 if end else first))

    def _position(self, offset: int) -> int:
        piece = max(0, bisect_right(self.offsets, offset) - 1)
        return self.places[piece] + offset - self.offsets[piece]


def read_xml(source: Source) -> Element:
    """Read a text as XML.

    Raises:
        ModelError: it is not well-formed, declares entities, or is too large or too deep.
    """
    text = source.text
    if len(text) > MAX_CHARACTERS:
        raise model_error("TA019", f"the text has more than {MAX_CHARACTERS:,} characters", None)
    data = text.encode("utf-8")
    reader = _Reader(source, data)
    try:
        # The text is already decoded, whatever encoding its declaration names.
        parser = expat.ParserCreate(encoding="utf-8")
        reader.read(parser, data)
    except expat.ExpatError as error:
        place = reader.position(parser.ErrorByteIndex)
        message = f"no well-formed XML: {expat.errors.messages[error.code]}"
        raise model_error("TA018", message, Span(source, place, place)) from None
    assert reader.root is not None, "well-formed XML has a root"
    return reader.root


class _Reader:
    def __init__(self, source: Source, data: bytes) -> None:
        self.root: Element | None = None
        self._source = source
        self._data = data
        self._open: list[Element] = []
        self._parser: Any = None
        self._reached = (0, 0)

    def read(self, parser: Any, data: bytes) -> None:  # expat's parser type has no public name
        self._parser = parser
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._characters
        parser.EntityDeclHandler = self._entity
        parser.Parse(data, True)

    def position(self, byte: int) -> int:
        """The character that a byte of the file belongs to; asked of later and later bytes."""
        if len(self._data) == len(self._source.text):
            return byte
        before, characters = self._reached
        characters += len(self._data[before:byte].decode("utf-8", errors="ignore"))
        self._reached = (byte, characters)
        return characters

    def _here(self) -> int:
        return self.position(self._parser.CurrentByteIndex)

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        element = Element(name, attributes, self._source, self._here())
        if len(self._open) >= MAX_DEPTH:
            raise model_error("TA019", "elements are nested too deeply", element.span())
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, _name: str) -> None:
        element = self._open.pop()
        element.text = "".join(element.pieces)

    def _characters(self, data: str) -> None:
        element = self._open[-1]
        last = element.offsets[-1] + len(element.pieces[-1]) if element.pieces else 0
        element.offsets.append(last)
        element.places.append(self._here())
        element.pieces.append(data)

    def _entity(self, name: str, *_rest: object) -> None:
        here = self._here()
        fix = "write the text itself"
        span = Span(self._source, here, here)
        raise model_error("TA018", f"the entity `{name}` is declared", span, fix)
