"""Resolves names: collects declarations, overrides constants, finds cycles and unused names."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import TypeVar

from msgspec import Struct
from msgspec.structs import replace

from rvmon.diagnostics import Diagnostic, Source
from rvmon.language.checked.functions import FUNCTIONS
from rvmon.language.checked.names_read import names_of_spec
from rvmon.language.checked.specification import CheckedSpec, Event, Signal
from rvmon.language.rules import Findings
from rvmon.language.rules import names as rules
from rvmon.language.rules import requirements as trigger_rules
from rvmon.language.syntax import items
from rvmon.language.syntax.expressions import Call, Expression, Ident, Name, expressions_in
from rvmon.language.syntax.parse import parse_expression

Declared = items.SignalSyntax | items.EventSyntax | items.DefineItem | items.ConstItem


class ResolvedSpec(Struct, frozen=True):
    """All items of a specification, each under its name."""

    sources: tuple[Source, ...]  # the main file, then those it imports
    header: items.Header | None  # its `spec` line, if it has one
    time: items.TimeItem | None  # its `time` line, if it has one
    delay: items.DelayItem | None  # its `max delay` line, if it has one
    declared: Mapping[str, Declared]  # signals, events, macros and constants by name, in order
    requirements: Mapping[str, items.RequirementItem]  # by id, in order
    properties: Mapping[str, items.PropertyItem]  # outside requirements, by id, in order
    covers: Mapping[str, items.CoverItem]  # by id, in order
    coverpoints: Mapping[str, items.CoverpointItem]  # by name, in order
    crosses: Mapping[str, items.CrossItem]  # by name, in order
    doubtful: frozenset[str]  # words of items that could not be read


_Stated = (
    items.RequirementItem
    | items.PropertyItem
    | items.CoverItem
    | items.CoverpointItem
    | items.CrossItem
)
_S = TypeVar("_S", bound=_Stated)


def resolve(parsed: Sequence[items.ParsedSpec], findings: Findings) -> ResolvedSpec:
    """Collect the items of a file and its imports; of equal names the first one is kept."""
    resolver = _Resolver(findings)
    for number, file in enumerate(parsed):
        for item in file.items:
            # The `spec` line of an imported file names only that file; its `time` applies to all.
            if number == 0 or not isinstance(item, items.Header):
                resolver.add(item)
    once = resolver.once
    return ResolvedSpec(
        tuple(file.source for file in parsed),
        *(once.get(items.Header), once.get(items.TimeItem), once.get(items.DelayItem)),  # type: ignore[arg-type]  # each is of its own class
        resolver.declared,
        resolver.of(items.RequirementItem),
        resolver.of(items.PropertyItem),
        resolver.of(items.CoverItem),
        resolver.of(items.CoverpointItem),
        resolver.of(items.CrossItem),
        # With two declarations of a name it is unknown which one a use refers to. The second one
        # was reported, so findings about uses are suppressed.
        frozenset(resolver.doubled).union(*(file.doubtful for file in parsed)),
    )


class _Resolver:
    def __init__(self, findings: Findings) -> None:
        self.doubled: set[str] = set()
        self._findings = findings
        self.once: dict[type, items.Header | items.TimeItem | items.DelayItem] = {}
        self.declared: dict[str, Declared] = {}
        self._stated: list[_Stated] = []
        self._first: dict[tuple[str, str], Ident] = {}

    def of(self, kind: type[_S]) -> dict[str, _S]:
        return {stated.name.text: stated for stated in self._stated if isinstance(stated, kind)}

    def add(self, item: items.Item) -> None:
        match item:
            case items.Header() | items.TimeItem() | items.DelayItem():
                earlier = self.once.setdefault(type(item), item)
                if earlier is not item:
                    word = item.span.text.split(maxsplit=1)[0]
                    self._findings.add(rules.double_item(word, item.span, earlier.span))
            case items.Declarations(each=each):
                for declared in each:
                    self._declare(declared)
            case items.DefineItem(parameters=parameters):
                for parameter, other in combinations(parameters or (), 2):
                    if parameter.text == other.text:
                        places = other.span, parameter.span
                        self._findings.add(rules.double(other.text, "parameter", *places))
                self._declare(item)
            case items.ConstItem():
                self._declare(item)
            case items.ImportItem():
                pass  # the imported file is itself in `parsed`
            # Requirements, properties, goals, coverpoints and crosses share one namespace, because
            # reports list them by id.
            case _ if self._is_new("requirement", item.name):
                self._stated.append(item)

    def _declare(self, declared: Declared) -> None:
        name = declared.name
        if name.text in FUNCTIONS and isinstance(declared, items.DefineItem):
            self._findings.add(rules.built_in(name.span))
        if self._is_new("name", name):
            self.declared[name.text] = declared
        else:
            self.doubled.add(name.text)

    def _is_new(self, kind: str, name: Ident) -> bool:
        first = self._first.setdefault((kind, name.text), name)
        if first is not name:
            self._findings.add(rules.double(name.text, kind, name.span, first.span))
        return first is name


def overridden(
    files: Sequence[items.ParsedSpec], constants: Mapping[str, str], findings: Findings
) -> list[items.ParsedSpec]:
    """The files with the values of the given constants replaced."""
    values: dict[str, Expression] = {}
    known = [
        item.name.text for file in files for item in file.items if isinstance(item, items.ConstItem)
    ]
    for name, text in constants.items():
        if name not in known:
            findings.add(rules.unknown_constant(name, known))
            continue
        value, wrong = parse_expression(Source(f"<constant {name}>", text))
        findings.extend(wrong)
        if value is not None:
            values[name] = value

    def with_value(item: items.Item) -> items.Item:
        if isinstance(item, items.ConstItem) and item.name.text in values:
            return replace(item, value=values[item.name.text])
        return item

    return [replace(file, items=tuple(map(with_value, file.items))) for file in files]


def find_cycles(declared: Mapping[str, Declared], findings: Findings) -> frozenset[str]:
    """The names of macros and constants that lead into a cycle; each cycle is reported once."""
    uses = {
        name: sorted(set(_used(item)) & declared.keys())
        for name, item in declared.items()
        if isinstance(item, items.DefineItem | items.ConstItem)
    }
    caught: set[str] = set()
    finished: set[str] = set()
    for root in uses:
        # A depth-first search without recursion: a chain of macros may be as long as the file.
        path: list[str] = []
        waiting = [(root, iter(uses[root]))] if root not in finished else []
        while waiting:
            name, rest = waiting[-1]
            # `path` has the names of `waiting`; the last one is new if it is shorter.
            if len(path) < len(waiting):
                path.append(name)
            following = next((n for n in rest if n in uses and n not in finished), None)
            if following is None:
                finished.add(name)
                waiting.pop()
                path.pop()
                # A macro that leads into a cycle cannot be evaluated either, but only the cycle
                # itself is reported.
                if caught & set(uses[name]):
                    caught.add(name)
            elif following in path:
                circle = path[path.index(following) :]
                caught.update(circle)
                place = declared[circle[0]].name.span
                shown = " → ".join(f"`{one}`" for one in [*circle, circle[0]])
                findings.add(rules.recursive(place, circle[0], shown))
            else:
                waiting.append((following, iter(uses[following])))
    return frozenset(caught)


def _used(item: items.DefineItem | items.ConstItem) -> Iterator[str]:
    parameters: frozenset[str] = frozenset()
    body: Expression = item.value if isinstance(item, items.ConstItem) else item.body
    if isinstance(item, items.DefineItem) and item.parameters:
        parameters = frozenset(parameter.text for parameter in item.parameters)
    for part in expressions_in(body):
        if isinstance(part, Name) and part.text not in parameters:
            yield part.text
        elif isinstance(part, Call):
            yield part.function.text


_NO_CODE = re.compile(r'"([^"\\\n]|\\.)*"|#[^\n]*')
_NAME = re.compile(r"`[^`\n]+`|[^\W\d]\w*(?:\.\w+)*")


def unused_names(spec: ResolvedSpec, checked: CheckedSpec) -> Iterator[Diagnostic]:
    """A finding for each name of the main file that is never used.

    A file without requirements, properties, goals or coverpoints is skipped: it only declares
    names for the files that import it.
    """
    demands = (spec.requirements, spec.properties, spec.covers, spec.coverpoints)
    if any(demands):
        yield from _never_read(checked)
        yield from _never_used(spec)


def _never_read(spec: CheckedSpec) -> Iterator[Diagnostic]:
    """Signals and events of the main file that nothing reads."""
    read = frozenset(names_of_spec(spec))
    declared: dict[str, Signal | Event] = {**spec.signals, **spec.events}
    for name, one in declared.items():
        if name not in read and one.span is not None and one.span.source is spec.source:
            kind = "signal" if name in spec.signals else "event"
            yield trigger_rules.never_read(one.span, kind, one.span.text.strip("`"))


def _never_used(spec: ResolvedSpec) -> Iterator[Diagnostic]:
    """Macros, constants and `let` values of the main file that are not used."""
    main = spec.sources[0]
    # Uses are counted in the text, so that a use in an unused macro counts. The declaration counts
    # too, so an unused name occurs once.
    uses = Counter(name for source in spec.sources for name in _names(source.text))
    for item in spec.declared.values():
        is_own = isinstance(item, items.DefineItem | items.ConstItem)
        if is_own and item.name.span.source is main and uses[item.name.text] < 2:
            yield rules.unused(item.name.span, item.word, item.name.text)
    for requirement in spec.requirements.values():
        lets = [clause for clause in requirement.clauses if isinstance(clause, items.LetClause)]
        if lets and requirement.span.source is main:
            uses_within = Counter(_names(requirement.span.text))
            for let in (clause.name for clause in lets if uses_within[clause.name.text] < 2):
                yield rules.unused(let.span, "let", let.text)


def _names(text: str) -> Iterator[str]:
    """All names in a text, except in comments and strings."""
    for match in _NAME.finditer(_NO_CODE.sub(" ", text)):
        yield match[0].strip("`")
