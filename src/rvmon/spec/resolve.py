"""From items to names: every name is declared once."""

from __future__ import annotations

from typing import assert_never

from rvmon.diagnostics.diagnostic import Diagnostic
from rvmon.spec.items import (
    ConstItem,
    DefineItem,
    DelayItem,
    EventItem,
    Header,
    Item,
    ParsedSpec,
    PropertyItem,
    RequirementItem,
    SignalItem,
    TimeItem,
)
from rvmon.spec.resolved import Declared, DeclaredEvent, DeclaredSignal, ResolvedSpec
from rvmon.spec.rules import names as rules
from rvmon.spec.syntax import Ident
from rvmon.spec.words import FUNCTIONS


def resolve(parsed: ParsedSpec) -> tuple[ResolvedSpec, list[Diagnostic]]:
    """Gather the declarations of a file.

    Returns:
        The specification with the first declaration of every name, and the findings.
    """
    resolver = _Resolver()
    for item in parsed.items:
        resolver.add(item)
    once = resolver.once
    spec = ResolvedSpec(
        parsed.source,
        once.get(Header),  # type: ignore[arg-type]
        once.get(TimeItem),  # type: ignore[arg-type]
        once.get(DelayItem),  # type: ignore[arg-type]
        resolver.declared,
        resolver.requirements,
        resolver.properties,
        parsed.doubtful,
    )
    return spec, resolver.findings


class _Resolver:
    def __init__(self) -> None:
        self.findings: list[Diagnostic] = []
        self.once: dict[type, Header | TimeItem | DelayItem] = {}
        self.declared: dict[str, Declared] = {}
        self.requirements: dict[str, RequirementItem] = {}
        self.properties: dict[str, PropertyItem] = {}
        self._first: dict[tuple[str, str], Ident] = {}

    def add(self, item: Item) -> None:
        match item:
            case Header() | TimeItem() | DelayItem():
                earlier = self.once.setdefault(type(item), item)
                if earlier is not item:
                    word = item.span.text.split(maxsplit=1)[0]
                    self.findings.append(rules.double_item(word, item.span, earlier.span))
            case SignalItem(names=names):
                for name in names:
                    self._declare(DeclaredSignal(name, item.type, item.role, item.stale_after))
            case EventItem(events=events):
                for event in events:
                    self._declare(DeclaredEvent(event.name, event, item.role))
            case DefineItem() | ConstItem():
                self._declare(item)
            case RequirementItem():
                if self._is_new("requirement", item.name):
                    self.requirements[item.name.text] = item
            case PropertyItem():
                if self._is_new("requirement", item.name):
                    self.properties[item.name.text] = item
            case _:
                assert_never(item)

    def _declare(self, declared: Declared) -> None:
        name = declared.name
        if name.text in FUNCTIONS and isinstance(declared, DefineItem):
            self.findings.append(rules.built_in(name.span))
        if self._is_new("name", name):
            self.declared[name.text] = declared

    def _is_new(self, kind: str, name: Ident) -> bool:
        first = self._first.setdefault((kind, name.text), name)
        if first is not name:
            self.findings.append(rules.double(kind, name.text, name.span, first.span))
        return first is name
