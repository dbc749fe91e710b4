"""What is declared and used nowhere: signals, events, macros, constants, captured values."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping

from rvmon.diagnostics.diagnostic import Diagnostic
from rvmon.spec.checked.reads import names_of_spec
from rvmon.spec.checked.specification import CheckedSpec, Event, Signal
from rvmon.spec.names.resolved import ResolvedSpec
from rvmon.spec.rules import names as name_rules
from rvmon.spec.rules import triggers as trigger_rules
from rvmon.spec.syntax.items import ConstItem, DefineItem, LetClause

_NO_CODE = re.compile(r'"([^"\\\n]|\\.)*"|#[^\n]*')
_NAME = re.compile(r"`[^`\n]+`|[^\W\d]\w*(?:\.\w+)*")


def unused_names(spec: ResolvedSpec, checked: CheckedSpec) -> Iterator[Diagnostic]:
    """A finding for each name of the main file that nothing uses.

    A file that demands nothing, only declares for others, is not looked at.
    """
    demands = (spec.requirements, spec.properties, spec.covers, spec.coverpoints)
    if any(demands):
        yield from _never_read(checked)
        yield from _never_used(spec)


def _never_read(spec: CheckedSpec) -> Iterator[Diagnostic]:
    """Signals and events that nothing reads."""
    read = frozenset(names_of_spec(spec))
    kinds: tuple[tuple[str, Mapping[str, Signal | Event]], ...] = (
        ("signal", spec.signals),
        ("event", spec.events),
    )
    for kind, names in kinds:
        for name, declared in names.items():
            span = declared.span
            if name not in read and span is not None and span.source is spec.source:
                yield trigger_rules.never_read(span, kind)


def _never_used(spec: ResolvedSpec) -> Iterator[Diagnostic]:
    """Macros and constants, and the values that requirements capture."""
    main = spec.sources[0]
    uses = Counter(name for source in spec.sources for name in _names(source.text))
    for item in spec.declared.values():
        if isinstance(item, DefineItem | ConstItem) and item.name.span.source is main:
            kind = "define" if isinstance(item, DefineItem) else "const"
            if uses[item.name.text] < 2:
                yield name_rules.unused(item.name.span, kind)
    for requirement in spec.requirements.values():
        lets = [clause for clause in requirement.clauses if isinstance(clause, LetClause)]
        if lets and requirement.span.source is main:
            own = Counter(_names(requirement.span.text))
            yield from (
                name_rules.unused(let.name.span, "let") for let in lets if own[let.name.text] < 2
            )


def _names(text: str) -> Iterator[str]:
    """The names in a text, wherever they stand but in comments and strings."""
    for found in _NAME.finditer(_NO_CODE.sub(" ", text)):
        yield found[0].strip("`")
