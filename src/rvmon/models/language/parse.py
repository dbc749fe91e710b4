"""Text to syntax: whole `.ta` files, and single labels for other text forms."""

from __future__ import annotations

import re
from functools import cache, partial
from importlib import resources
from typing import Any

import lark

from rvmon.diagnostics import Source, Span
from rvmon.errors import ModelError
from rvmon.language.syntax.grammar_cache import parser_of
from rvmon.models.language.automaton_syntax import Document, QueryText
from rvmon.models.language.foreign import reason_at
from rvmon.models.language.mistakes import Place, all_mistakes
from rvmon.models.language.syntax_builder import SyntaxBuilder
from rvmon.models.network.rules import model_error, refusal

STARTS = (
    "document",
    "declarations",
    "parameters",
    "selections",
    "conditions",
    "leaving",
    "sync",
    "updates",
    "instances",
    "system",
    "query",
)

MAX_CHARACTERS = 2_000_000
"""Longer texts are refused: no model for people is that long."""


def parse_document(source: Source) -> Document:
    """Read a whole `.ta` text.

    Raises:
        ModelError: the text is no model; the diagnostics say where and what was expected.

    >>> parse_document(Source("tiny.ta", "automaton a { location l start l }")).templates[0].name
    'a'
    """
    parts = parse_part(source.text, "document", lambda start, end: Span(source, start, end))
    name, title, unit, declarations, templates, instances, system, queries, signals = parts
    return Document(
        source, name, title, unit, declarations, templates, instances, system, queries, signals
    )


def parse_query(text: str) -> QueryText:
    """Read one query.

    Raises:
        ModelError: the text is no query.
    """
    source = Source("<query>", text)
    formula = parse_part(text, "query", lambda start, end: Span(source, start, end))
    return QueryText("", "", text, formula, Span(source, 0, len(text)))


def parse_part(text: str, start: str, place: Place) -> Any:
    """Read a text by one of the grammar's start rules; `place` maps its offsets to spans.

    Returns:
        What `SyntaxBuilder` makes of that rule.

    Raises:
        ModelError: the text does not belong to the rule; it has the mistakes of all parts.
    """
    try:
        return _read(start, text, place)
    except ModelError:
        found = all_mistakes(text, start, place, partial(_read, start))
    raise refusal(*found)


def _read(start: str, text: str, place: Place) -> Any:
    if len(text) > MAX_CHARACTERS:
        raise model_error("TA019", f"the text has more than {MAX_CHARACTERS:,} characters", None)
    try:
        tree = _parser(whole=start == "document").parse(text, start=start)
        return SyntaxBuilder(place).transform(tree)
    except lark.exceptions.UnexpectedInput as error:
        raise _syntax_error(error, text, start, place) from None
    except lark.exceptions.VisitError as error:
        raise error.orig_exc from None
    except RecursionError:
        raise model_error("TA019", "an expression is nested too deeply", None, "split it") from None


@cache
def _parser(whole: bool) -> lark.Lark:
    """The parser of `.ta` files, or that of their parts, in which words of the former are names."""
    grammar = resources.files("rvmon.models.language").joinpath("ta.lark").read_text("utf-8")
    starts = list(STARTS[:1] if whole else STARTS[1:])
    options = {"parser": "lalr", "start": starts, "propagate_positions": True}
    return parser_of(grammar, options)


def _syntax_error(
    error: lark.exceptions.UnexpectedInput, text: str, rule: str, place: Place
) -> ModelError:
    token = getattr(error, "token", None)
    expected = getattr(error, "expected", None) or getattr(error, "allowed", None) or ()
    at_end = token is not None and token.type == "$END"
    start = len(text) if at_end else error.pos_in_stream or 0
    length = 0 if at_end else len(token) if token is not None else 1
    found = "the end" if at_end else f"`{text[start : start + length]}`"
    if (reason := reason_at(text, start, length, rule)) is not None:
        return model_error("TA016", reason[0], place(start, start + length), reason[1])
    words = _words(set(expected))
    message = f"found {found}" + (f", expected {words}" if words else "")
    return model_error("TA001", message, place(start, start + length), _fix(text, start))


def _fix(text: str, offset: int) -> str:
    """The fix for a syntax error, if it is a common one."""
    for operator in _PATH.finditer(text):
        if operator.start() <= offset < operator.end():
            return f"inside a formula it takes brackets: ({operator[0]} …)"
    word = next((one for one in _WORD.finditer(text) if one.start() <= offset < one.end()), None)
    if word is not None and (text[offset] == "-" or word[0][0].isdigit()):
        name = re.sub(r"\W", "_", word[0]).lstrip("0123456789_")
        return f"a name is letters, digits and `_`, first a letter: `{name}`" if name else ""
    return ""


_PATH = re.compile(r"[AE](?:<>|\[\])")
_WORD = re.compile(r"[^\W_][\w-]*")
"""Text that was meant as a name."""

_OPERATORS = {
    "_AND", "_OR", "IMPLY", "EQUALITY", "RELATION", "PLUS", "MINUS", "FACTOR", "LSQB", "DOT",
    "RECEIVE",
}  # fmt: skip
_EXPRESSION_STARTS = {"NUMBER", "NAME", "LPAR", "SEND", "NOT", "MINUS", "TRUTH"}


def _words(terminals: set[str]) -> str:
    """The terminals that could have stood there, in words; at most eight of them."""
    words = []
    if terminals >= _EXPRESSION_STARTS:
        words.append("an expression")
        terminals = terminals - _EXPRESSION_STARTS - {"QUANTIFIER", "CTL"}
    if "RELATION" in terminals:
        words.append("an operator")
        terminals = terminals - _OPERATORS
    words += sorted(filter(None, map(_word, terminals)))
    return " or ".join(words) if len(words) <= 8 else ""


def _word(terminal: str) -> str:
    match terminal:
        case "NAME":
            return "a name"
        case "NUMBER" | "DECIMAL":
            return "a number"
        case "STRING":
            return 'a text in "quotes"'
        case "PATH":
            return "`E<>`, `A[]`, `A<>`, `E[]`"
        case "$END":
            return "the end"
        case _:
            pattern = _parser(whole=True).get_terminal(terminal).pattern
            return f"`{pattern.value}`" if pattern.type == "str" else ""
