"""Reads UPPAAL's XML.

Supported: declarations, templates with parameters, locations (invariant, exponential rate, urgent,
committed), edges (select, guard, synchronisation, assignment), branch points, instances, the system
line, queries. Colours, coordinates and test code do not affect runs and are ignored. Anything that
`ta.lark` has no rule for is refused with its place and the reason. A query that cannot be read or
resolved is skipped with a warning. Entity declarations are refused, nothing outside the file is
read, and size and depth are limited.

UPPAAL has no unit of time, weights, labels, or ids of queries. They are read from comments as
`uppaal_xml` writes them: `// unit 50 ms` in the declarations; `weight 0.9` and `as name` in the
comments of an edge; `query R1` alone on the first line of the comment of a query.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from msgspec.structs import replace

from rvmon.diagnostics import Diagnostic, Source, Span
from rvmon.errors import ModelError
from rvmon.models import finding, model_error, skipped_query
from rvmon.models.language import automaton_syntax, syntax
from rvmon.models.language.automaton_syntax import Document
from rvmon.models.language.declare import Findings
from rvmon.models.language.parse import MAX_CHARACTERS, parse_part
from rvmon.models.language.unsupported import without_comments
from rvmon.models.network.expressions import LocationKind
from rvmon.trace.time import TICKS_PER_UNIT

MAX_DEPTH = 20  # limit for the nesting of elements; models need less


@dataclass(slots=True)
class Element:
    """An element with its joined text, and the place of each piece of the text."""

    name: str
    attributes: Mapping[str, str]
    source: Source
    start: int
    children: list[Element] = field(default_factory=list)
    text: str = ""
    pieces: list[str] = field(default_factory=list)  # of the text, as read
    offsets: list[int] = field(default_factory=list)  # of the pieces, in `text`
    places: list[int] = field(default_factory=list)  # of the pieces, in the file

    def all(self, name: str) -> Iterator[Element]:
        """The children with a name."""
        return (child for child in self.children if child.name == name)

    def first(self, name: str) -> Element | None:
        """The first child with a name."""
        return next(self.all(name), None)

    def span(self) -> Span:
        """The start of the element's tag."""
        return Span(self.source, self.start, self.start + len(self.name) + 1)

    def place(self, start: int, end: int) -> Span:
        """The place in the file of the characters `[start, end)` of the text."""
        if not self.offsets:
            return self.span()
        first = self._position(start)
        return Span(self.source, first, max(first, self._position(end - 1) + 1 if end else first))

    def _position(self, offset: int) -> int:
        piece = max(0, bisect_right(self.offsets, offset) - 1)
        return self.places[piece] + offset - self.offsets[piece]


def read_xml(source: Source) -> Element:
    """Read a text as XML."""
    text = source.text
    if len(text) > MAX_CHARACTERS:
        raise model_error("TA019", f"the text has more than {MAX_CHARACTERS:,} characters", None)
    reader = _Reader(source)
    try:
        reader.parser.Parse(reader.data, True)
    except expat.ExpatError as error:
        place = reader.position(reader.parser.ErrorByteIndex)
        message = f"not well-formed XML: {expat.errors.messages[error.code]}"
        raise model_error("TA018", message, Span(source, place, place)) from None
    (root,) = reader.around.children
    return root


class _Reader:
    def __init__(self, source: Source) -> None:
        self.data = source.text.encode("utf-8")
        # The text is decoded already, whatever encoding its declaration names.
        self.parser = expat.ParserCreate(encoding="utf-8")
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._characters
        self.parser.EntityDeclHandler = self._entity
        self.around = Element("", {}, source, 0)  # holds the outermost element
        self._source = source
        self._open = [self.around]
        self._reached = (0, 0)

    def position(self, byte: int) -> int:
        """The character at a byte offset of the file; offsets must not decrease between calls."""
        if len(self.data) == len(self._source.text):
            return byte
        before, characters = self._reached
        characters += len(self.data[before:byte].decode("utf-8", errors="ignore"))
        self._reached = (byte, characters)
        return characters

    def _here(self) -> int:
        return self.position(self.parser.CurrentByteIndex)

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        element = Element(name, attributes, self._source, self._here())
        if len(self._open) > MAX_DEPTH:
            raise model_error("TA019", "elements are nested too deeply", element.span())
        self._open[-1].children.append(element)
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


_UNIT = re.compile(r"^[ \t]*//[ \t]*unit[ \t]+([1-9]\d{0,9})[ \t]+(\w+)[ \t]*$", re.MULTILINE)
_NOT = re.compile(r"\bnot\b")
_NAME = re.compile(
    r"^[ \t]*//[ \t]*network[ \t]+(\w+)(?:[ \t]+\"([^\"\n]*)\")?[ \t]*$", re.MULTILINE
)
_WEIGHT = re.compile(r"^[ \t]*weight[ \t]+(\d+(?:\.\d+)?)[ \t]*$", re.MULTILINE)
_QUERY = re.compile(r"\s*query[ \t]+([A-Za-z_]\w*)[ \t]*(?:\n|$)")
_LABEL = re.compile(r"^[ \t]*as[ \t]+(\S+)[ \t]*$", re.MULTILINE)


def read_uppaal(source: Source) -> tuple[Document, list[Diagnostic]]:
    """Read a model in UPPAAL's XML, and return it with the warnings."""
    root = read_xml(source)
    if root.name != "nta":
        fix = "the outermost element of UPPAAL's models is `nta`"
        raise model_error("TA018", f"`{root.name}` is not a model", root.span(), fix)
    findings, warnings = Findings(), list[Diagnostic]()
    declarations = _part(root.first("declaration"), "declarations", findings, ())
    templates = tuple(_template(element, findings) for element in root.all("template"))
    first = _part(root.first("instantiation"), "instances", findings, ())
    declared, instances, names = _part(root.first("system"), "system", findings, ((), (), None))
    queries = tuple(_queries(root, warnings))
    findings.raise_errors()
    text = _text(root.first("declaration"))
    name, unit = _NAME.search(text), _UNIT.search(text)
    document = Document(
        source, name[1] if name else "model", (name[2] or "") if name else "",
        int(unit[1]) * TICKS_PER_UNIT[unit[2]] if unit and unit[2] in TICKS_PER_UNIT else None,
        (*declarations, *declared), templates, (*first, *instances), names, queries, open_ints=True,
    )  # fmt: skip
    return document, warnings


def _text(element: Element | None) -> str:
    return "" if element is None else element.text


def _part(element: Element | None, start: str, findings: Findings, default: Any) -> Any:
    """Parse the text of an element by a rule of the grammar; `default` if there is none."""
    if element is not None and element.text.strip():
        with findings.collect():
            return _parsed(element, start)
    return default


def _parsed(element: Element, start: str) -> Any:
    """Parse a text. UPPAAL's `not` binds like its `!`, tighter than a comparison."""
    return parse_part(_NOT.sub("!  ", element.text), start, element.place)


def _template(element: Element, findings: Findings) -> automaton_syntax.Template:
    name = element.first("name")
    span = element.span() if name is None else name.place(0, len(name.text))
    if name is None or not name.text.strip():
        findings.add(finding("TA018", "a template without a name", span))
    names = {
        place.attributes.get("id", ""): _location_name(place) for place in element.all("location")
    }
    locations = tuple(_location(place, findings) for place in element.all("location"))
    return automaton_syntax.Template(
        _text(name).strip(), _part(element.first("parameter"), "parameters", findings, ()),
        _part(element.first("declaration"), "declarations", findings, ()), locations,
        _reference(element.first("init"), names), tuple(_edges(element, names, findings)), span,
    )  # fmt: skip


def _location_name(element: Element) -> str:
    return _text(element.first("name")).strip() or element.attributes.get("id", "")


def _location(element: Element, findings: Findings) -> automaton_syntax.LocationText:
    kind = LocationKind.NORMAL
    for mark in (LocationKind.URGENT, LocationKind.COMMITTED):
        if element.first(mark.value) is not None:
            kind = mark
    labels = _labels(element)
    name = element.first("name")
    span = element.span() if name is None else name.place(0, len(name.text))
    invariant = _part(labels.get("invariant"), "conditions", findings, None)
    leaving = _part(labels.get("exponentialrate"), "leaving", findings, None)
    return automaton_syntax.LocationText(_location_name(element), kind, invariant, span, leaving)


def _labels(element: Element) -> dict[str, Element]:
    return {label.attributes.get("kind", ""): label for label in element.all("label")}


def _reference(element: Element | None, names: Mapping[str, str]) -> syntax.Name | None:
    """The location that a `ref` denotes; an unknown one keeps its id, which no location has."""
    if element is None:
        return None
    reference = element.attributes.get("ref", "")
    return syntax.Name(names.get(reference, reference), element.span())


def _edges(
    template: Element, names: Mapping[str, str], findings: Findings
) -> Iterator[automaton_syntax.EdgeText]:
    """The edges. An edge to a branch point becomes one edge per branch."""
    branches: dict[str, list[tuple[automaton_syntax.EdgeText, syntax.Expression]]] = {
        point.attributes.get("id", ""): [] for point in template.all("branchpoint")
    }
    entering: list[tuple[str, automaton_syntax.EdgeText]] = []
    for element in template.all("transition"):
        edge = _edge(element, names, findings)
        ends = (element.first(end) for end in ("source", "target"))
        start, end = ("" if one is None else one.attributes.get("ref", "") for one in ends)
        if start in branches:
            weight = _part(_labels(element).get("probability"), "conditions", findings, None)
            branches[start].append((edge, weight or syntax.Number(1, edge.span)))
        elif end in branches:
            entering.append((end, edge))
        else:
            yield edge
    for point, edge in entering:
        every = tuple(weight for _, weight in branches[point])
        for branch, weight in branches[point]:
            updates = (*edge.updates, *branch.updates)
            yield replace(edge, target=branch.target, updates=updates, shares=(weight, every))


def _edge(
    element: Element, names: Mapping[str, str], findings: Findings
) -> automaton_syntax.EdgeText:
    labels = _labels(element)
    nowhere = syntax.Name("", element.span())
    comments = _text(labels.get("comments"))
    weight, label = _WEIGHT.search(comments), _LABEL.search(comments)
    if weight and not 0 < float(weight[1]) <= 1:
        message, fix = f"weight {weight[1]}", "a weight is a share: above 0, at most 1"
        findings.add(finding("TA017", message, labels["comments"].span(), fix))
        weight = None
    return automaton_syntax.EdgeText(
        _reference(element.first("source"), names) or nowhere,
        _reference(element.first("target"), names) or nowhere, element.span(),
        _part(labels.get("select"), "selections", findings, ()),
        _part(labels.get("guard"), "conditions", findings, None),
        _part(labels.get("synchronisation"), "sync", findings, None),
        _part(labels.get("assignment"), "updates", findings, ()),
        float(weight[1]) if weight else 1.0, label[1] if label else "",
    )  # fmt: skip


def _queries(root: Element, warnings: list[Diagnostic]) -> Iterator[automaton_syntax.QueryText]:
    queries = root.first("queries")
    for element in [] if queries is None else queries.all("query"):
        formula = element.first("formula")
        if formula is None or not without_comments(formula.text).strip():
            continue
        comment = _text(element.first("comment"))
        named = _QUERY.match(comment)
        remark = " ".join((comment[named.end() :] if named else comment).split())
        try:
            read = _parsed(formula, "query")
        except ModelError as error:
            warnings.append(skipped_query(formula.text, error.diagnostics[0]))
            continue
        length = len(formula.text.rstrip())
        text = formula.text.strip()
        span = formula.place(0, length)
        yield automaton_syntax.QueryText(named[1] if named else "", remark, text, read, span)
