"""Completion and hover: the words allowed at a place, and their meaning."""

from __future__ import annotations

import re
from collections.abc import Iterator

from rvmon.analysis.plain_english import requirement_in_words
from rvmon.cli.lsp.names import Names, about_word
from rvmon.diagnostics import Span
from rvmon.language.checked.functions import FUNCTIONS
from rvmon.language.checked.specification import CheckedSpec, EndPolicy
from rvmon.language.syntax.expressions import Ident
from rvmon.language.syntax.items import ConstItem, CoverpointItem, DefineItem, RequirementItem
from rvmon.language.syntax.keywords import ITEM_WORDS, NOT_UNITS, split_items
from rvmon.language.syntax.parse import grammar
from rvmon.language.syntax.syntax_errors import accepted_terminals, words_of
from rvmon.units import unit_table

_NO_CODE = re.compile(r'`[^`\n]*`|"(?:[^"\\\n]|\\.)*"')
_BEGUN = re.compile(r"(?:`[^`\n]*|[^\W\d][\w.]*|%)\Z")
_NUMBER = re.compile(
    r"(?<![\w.])(?P<number>\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)[ \t]*(?:[\w%^-]+[*/])*\Z"
)
_BRACKET = re.compile(r"(?<![\w.])real[ \t]*\[[^\]\n]*\Z")
_COMPARED = re.compile(r"`?([^\W\d][\w.]*)`?[ \t]*(?:==|!=|=)[ \t]*\Z")
_OWN = re.compile(r"(?<![\w.])(?:let|each)\s+([^\W\d][\w.]*)|\Adefine\s+\w[\w.]*\(([^)]*)\)")


def proposals(names: Names, place: Span) -> tuple[Span, dict[str, str]]:
    """The incomplete word at a place, and its completions, each with its kind."""
    text = place.source.text[: place.start]
    line = _NO_CODE.sub("", text[text.rfind("\n") + 1 :])
    word = _BEGUN.search(text)
    if "#" in line or '"' in line:
        return place, {}
    start = word.start() if word else place.start
    before = text[:start]
    items = split_items(before)
    item = before[items[-1][0] :] if items else ""
    alone = not before[before.rfind("\n") + 1 :].strip()
    completions = dict(_candidates(names, item, alone=alone))
    return Span(place.source, start, place.start), completions


def _candidates(names: Names, item: str, *, alone: bool) -> Iterator[tuple[str, str]]:
    accepted, read = accepted_terminals(grammar(), item, "item")
    compared = _COMPARED.search(item)
    if compared and (type_ := names.types.get(compared[1])) and type_.labels:
        yield from ((label.span.text, "label") for label in type_.labels)
        return
    yield from _units(item)
    # If the item has an error before this place, anything may follow.
    if not read:
        accepted = {terminal.name for terminal in grammar().terminals}
    if {"NAME", "NUMBER"} <= accepted:
        yield from _operands(names, item, formulas="TRUTH" in accepted)
    elif "NAME" in accepted:
        yield from _named(names, item)
    for terminal in sorted(accepted - {"$END"}):
        yield from ((word, "keyword") for word in words_of(terminal, grammar()))
    if alone and "$END" in accepted:
        yield from ((word, "keyword") for word in (*ITEM_WORDS, "max delay"))


def _units(item: str) -> Iterator[tuple[str, str]]:
    """Units in a type or after a number; only those of time where a duration is expected."""
    if _BRACKET.search(item):
        yield from ((unit, "unit") for unit in unit_table())
    elif number := _NUMBER.search(item):
        accepted, read = accepted_terminals(grammar(), item[: number.start()], "item")
        duration = read and "TRUTH" not in accepted
        for name, unit in unit_table().items():
            if name not in NOT_UNITS and not (duration and unit.dimension != (("s", 1),)):
                yield name, "unit"


def _operands(names: Names, item: str, *, formulas: bool) -> Iterator[tuple[str, str]]:
    """Names that a formula or, without `formulas`, a duration may contain."""
    for name, parameters in _OWN.findall(item):
        yield from ((local.strip(), "name") for local in (name or parameters).split(","))
    if item.startswith("cross"):
        yield from _coverpoints(names)
        return
    for name, ident in names.declared.items():
        declaring = names.owners[id(ident)]
        called = isinstance(declaring, DefineItem) and declaring.parameters is not None
        if formulas or isinstance(declaring, ConstItem):
            written = name if ident.text != name else ident.span.text
            yield f"{written}(" if called else written, "function" if called else "name"
    if formulas:
        yield from ((f"{name}(", "function") for name in FUNCTIONS)


def _named(names: Names, item: str) -> Iterator[tuple[str, str]]:
    """Names at places that allow only some; none where a new name is expected."""
    if re.search(r"(?<![\w.])at\s+end\s*:?\s*\Z", item):
        yield from ((policy.value, "keyword") for policy in EndPolicy)
    elif item.startswith("cross") and "=" in item:
        yield from _coverpoints(names)


def _coverpoints(names: Names) -> Iterator[tuple[str, str]]:
    for ident in names.goals.values():
        if isinstance(names.owners[id(ident)], CoverpointItem):
            yield ident.span.text, "name"


def hover(names: Names, checked: CheckedSpec | None, place: Span) -> tuple[Span, str] | None:
    """The word at a place and its meaning in Markdown; `None` if there is none."""
    if use := names.at(place):
        return use[0], _about(names, checked, use[1])
    word = about_word(place)
    return word if word and word[1] else None


def _about(names: Names, checked: CheckedSpec | None, name: Ident) -> str:
    """A requirement in words; for any other name, the text of its declaration."""
    item = names.item_at(name.span)
    requirement = checked.requirements.get(name.text) if checked else None
    if requirement is not None and isinstance(item, RequirementItem) and name is item.name:
        kept = {
            "source": requirement.source,
            "rationale": requirement.rationale,
            "severity": requirement.severity,
        }
        clauses = [f"*{word}*: {text}" for word, text in kept.items() if text]
        words = "  \n".join(requirement_in_words(requirement))
        return "\n\n".join([f"**{requirement.id}** {requirement.text}", words, *clauses])
    clauses_ = item.clauses if isinstance(item, RequirementItem) else ()
    spans = (clause.span for clause in clauses_)
    whole = item.span if item else name.span
    declaring = next((s for s in spans if s.start <= name.span.start < s.end), whole)
    return f"```rv\n{declaring.text}\n```"
