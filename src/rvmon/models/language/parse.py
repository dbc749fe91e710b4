"""Parsing: `.ta` files, and single labels of other text forms. Finds all mistakes of a text."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import cache
from importlib import resources
from typing import Any

import lark

from rvmon.diagnostics import Diagnostic, Source, Span
from rvmon.errors import ModelError
from rvmon.language.syntax.grammar_cache import parser_of
from rvmon.models import model_error, refusal
from rvmon.models.language.automaton_syntax import Document, QueryText
from rvmon.models.language.syntax_builder import SyntaxBuilder
from rvmon.models.language.unsupported import reason_at

STARTS = (
    *("document", "declarations", "parameters", "selections", "conditions", "leaving", "sync"),
    *("updates", "instances", "system", "query"),
)

MAX_CHARACTERS = 2_000_000  # longer texts are refused; no handwritten model is that long


def parse_document(source: Source) -> Document:
    """Read a whole `.ta` text.

    >>> parse_document(Source("tiny.ta", "automaton a { location l start l }")).templates[0].name
    'a'
    """
    parts = parse_part(source.text, "document", lambda start, end: Span(source, start, end))
    return Document(source, *parts)


def parse_query(text: str) -> QueryText:
    """Read one query."""
    source = Source("<query>", text)
    formula = parse_part(text, "query", lambda start, end: Span(source, start, end))
    return QueryText("", "", text, formula, Span(source, 0, len(text)))


def parse_part(text: str, start: str, place: Place) -> Any:
    """Parse a text by a start rule and build its syntax; `place` maps offsets to spans."""
    try:
        return _read(start, text, place)
    except ModelError:
        found = all_mistakes(text, start, place)
    raise refusal(*found)


def _read(start: str, text: str, place: Place) -> Any:
    if len(text) > MAX_CHARACTERS:
        raise model_error("TA019", f"the text has more than {MAX_CHARACTERS:,} characters", None)
    try:
        tree = _parser(whole=start == "document").parse(text, start=start)
        return SyntaxBuilder(place).transform(tree)
    except lark.exceptions.UnexpectedInput as error:
        raise _syntax_error(error, text, start, place) from None
    except (lark.exceptions.VisitError, RecursionError) as error:
        found = getattr(error, "orig_exc", error)
        if not isinstance(found, RecursionError):
            raise found from None
        raise model_error("TA019", "an expression is nested too deeply", None, "split it") from None


@cache
def _parser(whole: bool) -> lark.Lark:
    """The parser of whole `.ta` files, or of their parts, in which keywords of `.ta` are names."""
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
_WORD = re.compile(r"[^\W_][\w-]*")  # text that was meant as a name

_OPERATORS = {
    "_AND", "_OR", "IMPLY", "EQUALITY", "RELATION", "PLUS", "MINUS", "FACTOR", "LSQB", "DOT",
    "RECEIVE",
}  # fmt: skip
_EXPRESSION_STARTS = {"NUMBER", "NAME", "LPAR", "SEND", "NOT", "MINUS", "TRUTH"}


def _words(terminals: set[str]) -> str:
    """The terminals expected at a place, in words; empty if there are more than eight."""
    words = []
    if terminals >= _EXPRESSION_STARTS:
        words.append("an expression")
        terminals = terminals - _EXPRESSION_STARTS - {"QUANTIFIER", "CTL"}
    if "RELATION" in terminals:
        words.append("an operator")
        terminals = terminals - _OPERATORS
    words += sorted(set(filter(None, map(_word, terminals))))
    return " or ".join(words) if len(words) <= 8 else ""


_WORDS = {
    "NAME": "a name",
    "STRING": 'a text in "quotes"',
    "PATH": "`E<>`, `A[]`, `A<>`, `E[]`",
    **dict.fromkeys(("NUMBER", "DECIMAL"), "a number"),
    # Lark has two names for the end: one of the parser, one of the lexer.
    **dict.fromkeys(("$END", "<END-OF-FILE>"), "the end"),
}


def _word(terminal: str) -> str:
    if terminal in _WORDS:
        return _WORDS[terminal]
    pattern = _parser(whole=True).get_terminal(terminal).pattern
    return f"`{pattern.value}`" if pattern.type == "str" else ""


Place = Callable[[int, int], Span]
"""Maps the characters `[start, end)` of a text to their span in the file."""

MOST = 20  # the search for mistakes stops after so many, since each one needs another parse

LONGEST = 100_000
"""Of a longer text only the first mistake is reported, since each further one needs a parse."""

# At the start of a line, firm words always start a part; loose ones only outside brackets, since
# they may also occur inside a part.
_FIRM = "automaton|(?:(?:urgent|committed)[ \t]+)?location|edge|start|query|signal|unit|system"
_LOOSE = "clock|broadcast|urgent|chan|int|bool|const|meta|struct|typedef|void"
_DECLARED = (
    r'//[^\n]*|/\*.*?\*/|"[^"\n]*"|(?P<open>[{(\[])|(?P<close>[})\]])|(?P<end>;)'
    rf"|^[ \t]*(?P<loose>{_LOOSE})\b"
)
_TOKENS = {
    rule: re.compile(pattern, re.MULTILINE | re.DOTALL)
    for rule, pattern in (
        ("declarations", _DECLARED),
        ("system", _DECLARED),
        ("document", rf"{_DECLARED}|^[ \t]*(?P<firm>{_FIRM})\b"),
    )
}
"""The patterns at which parts begin and end, by start rule. Other rules read a single part."""


def all_mistakes(text: str, rule: str, place: Place) -> tuple[Diagnostic, ...]:
    """Find all mistakes of a text, by leaving out each part with a mistake in turn.

    Args:
        text: the text to parse.
        rule: the start rule.
        place: maps offsets of the text to spans.
    """
    starts = dict[int, int]()

    def noted(start: int, end: int) -> Span:
        span = place(start, end)
        starts[span.start] = start
        return span

    def first_mistake(text: str) -> ModelError | None:
        try:
            _read(rule, text, noted)
        except ModelError as error:
            return error
        return None

    def offset(error: ModelError) -> int:
        spans = error.diagnostics[0].spans
        return starts.get(spans[0].span.start, -1) if spans else -1

    found, error = list[Diagnostic](), first_mistake(text)
    while error is not None:
        found += error.diagnostics
        at, rest, error = offset(error), text, None
        if len(found) >= MOST or len(text) > LONGEST:
            break
        # A part that is cut short often shows only in the next one, since words that start a part
        # are names too. So try to leave out each of the last few parts: without the faulty one the
        # parser gets farthest.
        farthest = at
        for start, end in [part for part in _parts(text, rule) if part[0] <= at][-4:]:
            left = text[:start] + re.sub(r"\S", " ", text[start:end]) + text[end:]
            following = first_mistake(left)
            reached = len(text) if following is None else offset(following)
            if reached > farthest:
                farthest, rest, error = reached, left, following
                if following is None:
                    break
        text = rest
    return tuple(found)


def _parts(text: str, rule: str) -> Iterator[tuple[int, int]]:
    """Split a text into parts that can be left out singly: declarations, edges, queries."""
    if rule not in _TOKENS:
        return
    start, word, is_body, brackets = 0, "", False, list[str]()
    for token in _TOKENS[rule].finditer(text):
        kind = token.lastgroup
        if kind == "end" and "{" not in brackets:
            brackets.clear()  # these brackets were never closed
        while brackets[-1:] == ["["] and (kind == "loose" or token[0] in ("{", "}", ")")):
            brackets.pop()
        match kind:
            case "firm" | "loose" if kind == "firm" or not brackets:
                if word != "automaton":
                    yield start, token.start()
                start, word = token.start(), token[kind]
                brackets.clear()
            case "open" if word == "automaton" and token[0] == "{":
                start, word = token.end(), ""
                brackets.clear()
            case "open":
                if not brackets:
                    is_body = token[0] == "{" and text[: token.start()].rstrip().endswith(")")
                brackets.append(token[0])
            case "close" if brackets:
                brackets.pop()
                if not brackets and is_body and token[0] == "}":
                    yield start, token.end()
                    start, word = token.end(), ""
            case "close" if token[0] == "}" and rule == "document":  # the end of an automaton
                yield start, token.start()
                start, word = token.end(), ""
            case "end" if not brackets:
                if word != "automaton":
                    yield start, token.end()
                start, word = token.end(), ""
            case _:
                pass
    yield start, len(text)
