"""Text to syntax tree: every item alone, so that all errors of a file appear at once."""

from __future__ import annotations

import re
from functools import cache, lru_cache
from importlib import resources
from typing import Any

import lark
from lark.exceptions import UnexpectedInput, VisitError

from rvmon.diagnostics import Diagnostic, Source, Span
from rvmon.language.rules import Findings, Refusal
from rvmon.language.rules import syntax as rules
from rvmon.language.syntax.build import Builder
from rvmon.language.syntax.expected import explain_unexpected
from rvmon.language.syntax.expressions import Expression
from rvmon.language.syntax.grammar_cache import parser_of
from rvmon.language.syntax.items import Item, ParsedSpec
from rvmon.language.syntax.size_limits import LARGEST
from rvmon.language.syntax.words import (
    ITEM_WORDS,
    NOT_UNITS,
    OPERATOR_TERMINALS,
    RESERVED,
    split_items,
)
from rvmon.texts import nearest
from rvmon.units import compound_pattern

DEEPEST = 100
"""Expressions nested more deeply are refused."""

MOST_ENCLOSED = 200
"""The same with brackets that only enclose, which are no levels but take as much to read."""

KEPT = 4_000
"""Trees of items that are kept for the next time that the same text is read."""

_NO_CODE = re.compile(r'"[^"\n]*"|`[^`\n]*`|#[^\n]*')
_OPERATOR = re.compile(r"(?<![\w.])(?:and|or|xor|implies|iff)(?![\w.])|&&?|\|\|?|[+*]")

Parsed = tuple[Any, list[Diagnostic]]


def parse_spec(source: Source, findings: Findings) -> ParsedSpec:
    """Read a file; `findings` takes what is wrong with the items that are left out."""
    items: list[Item] = []
    doubtful: set[str] = set()
    waiting = split_items(source.text)[::-1]
    while waiting:
        start, end = waiting.pop()
        item, wrong = _parse(source, start, end, "item")
        if item is not None:
            items.append(item)
            findings.extend(wrong)
            continue
        cut = _misspelled_item(source.text, start, wrong)
        if cut is not None:
            waiting += ((cut, end), (start, cut))
            continue
        findings.extend(wrong)
        doubtful.update(re.findall(r"\w[\w.]*", source.text[start:end]))
    return ParsedSpec(source, tuple(items), frozenset(doubtful))


def _misspelled_item(text: str, start: int, findings: list[Diagnostic]) -> int | None:
    """The start of an item that was parsed as part of the one before, as `requirment R2` is."""
    place = findings[0].spans[0].span.start
    if place <= start or text[place - 1] != "\n":
        return None
    word = re.compile(r"\w+").match(text, place)
    return place if word and nearest(word[0], ITEM_WORDS, 0.75) else None


def parse_expression(source: Source) -> tuple[Expression | None, list[Diagnostic]]:
    """Read a text that is one expression, such as the value of a constant."""
    return _parse(source, 0, len(source.text), "expression")


def _parse(source: Source, start: int, end: int, rule: str) -> Parsed:
    if _operators(source.text[start:end]) > LARGEST:
        place = Span(source, start, start + len(source.text[start:end].rstrip()))
        return None, [rules.too_large(place, LARGEST)]
    builder = Builder(source, start)
    try:
        tree = _tree(source.text[start:end], rule)
        if (part := _too_deep(tree)) is not None:
            place = Span(source, start + part.meta.start_pos, start + part.meta.end_pos)
            return None, [rules.too_deep(place, DEEPEST)]
        return builder.transform(tree), builder.findings
    except UnexpectedInput as error:
        return None, [explain_unexpected(error, grammar(), source, start, end, rule)]
    except VisitError as error:
        if isinstance(error.orig_exc, Refusal):
            return None, [error.orig_exc.finding]
        raise


@lru_cache(KEPT)
def _tree(text: str, rule: str) -> lark.Tree[Any]:
    """The parser's tree; those of items that stay as they are while a file is edited are kept."""
    return grammar().parse(text, start=rule)


def _operators(text: str) -> int:
    """A lower bound on the operators in chains of a text, counted before it is parsed."""
    return 0 if len(text) < LARGEST else len(_OPERATOR.findall(_NO_CODE.sub("", text)))


@cache
def grammar() -> lark.Lark:
    """The parser, built once per process."""
    return parser_of(grammar_text(), GRAMMAR_OPTIONS)


GRAMMAR_OPTIONS: dict[str, Any] = {
    "parser": "lalr",
    "lexer": "contextual",
    "start": ["item", "expression"],
    "propagate_positions": True,
    "maybe_placeholders": False,
}


def grammar_text() -> str:
    """The grammar with its terminals filled in from the tables of words and units."""
    text = resources.files("rvmon.language.syntax").joinpath("rv.lark").read_text(encoding="utf-8")
    end = r"(?!\w|\.\w)"
    word = r"[^\W\d]\w*"
    fillings = {
        "END": end,
        "NAME": rf"(?!({_any(RESERVED)}){end}){word}(\.{word})*",
        "UNIT": rf"(?!({_any(NOT_UNITS)}){end}){word}",
        "COMPOUND": compound_pattern(NOT_UNITS).replace("/", r"\/"),
    }
    for terminal, spellings in OPERATOR_TERMINALS.items():
        fillings[terminal] = "|".join(
            re.escape(spelling).replace(r"\ ", r"\s+") + (end if spelling[-1].isalpha() else "")
            for spelling in sorted(spellings, key=len, reverse=True)
        )
    for key, pattern in fillings.items():
        text = text.replace(f"@{key}@", pattern)
    return text


def _any(words: frozenset[str]) -> str:
    return "|".join(sorted(words))


def _too_deep(tree: lark.Tree[Any]) -> lark.Tree[Any] | None:
    """The first part that is nested too deeply; brackets that only enclose are no level."""
    within = 0
    level = [tree]
    for _ in range(MOST_ENCLOSED):
        level = [part for node in level for part in node.children if isinstance(part, lark.Tree)]
        within += any(node.data != "group" for node in level)
        if not level:
            return None
        if within >= DEEPEST:
            break
    return level[0]
