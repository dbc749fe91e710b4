"""Syntax errors in the words of the language: what was found, what could have stood there."""

from __future__ import annotations

import re
from typing import Any

import lark
from lark.exceptions import UnexpectedInput, UnexpectedToken

from rvmon.diagnostics import Diagnostic, Source, Span
from rvmon.language.rules import finding, names, short, syntax, types
from rvmon.language.syntax.fixes import NAMELESS, fix_of, if_fix, words_of
from rvmon.language.syntax.words import ITEM_WORDS, NOT_UNITS, RESERVED
from rvmon.units import unit_table

_OPERAND = {"NUMBER", "NAME", "NOT", "TEMPORAL", "MINUS"}
_OPERAND_ALL = _OPERAND | {
    "WITHIN", "FOR", "IMMEDIATELY", "CTL", "PATH", "QUANTIFIER", "TRUTH", "START", "END", "CALL",
    "LPAR", "IF",
}  # fmt: skip
_VALUE = {"NUMBER", "NAME", "CALL", "LPAR", "MINUS"}
_DURATION = {"NUMBER", "NAME", "LPAR", "MINUS"}
_ARITHMETIC = {"PLUS", "TIMES", "DIVIDE"}
_INFIX = {
    "AND",
    "OR",
    "XOR",
    "IFF",
    "IMPLIES",
    "INFIX",
    "LEADS_TO",
    "COMPARE",
    "MINUS",
    "_IN",
    "NOT",
}
_CLAUSES = {
    "TEXT_CLAUSE", "SEVERITY", "TAGS", "LET", "FOR_EACH", "AT_END", "PROPERTY", "SCOPE",
    "RUN_SHARE",
}  # fmt: skip
_WORDS = {
    "NAME": "a name",
    "NUMBER": "a number",
    "STRING": 'a text in "quotes"',
    "UNIT": "a unit",
    "CALL": "a name with `(`",
    "$END": "the end of the item",
    "COMPARE": "a comparison",
    "MINUS": "`-`",
    "UNWANTED": "`ignore` or `illegal`",
    "RUN_SHARE": "`in at least`",
    "IFF": "`<->`",
    "IMPLIES": "`->`",
    "INFIX": "an operator such as `until`",
    "TEMPORAL": "an operator such as `always`",
    "CTL": "an operator such as `AG`",
    "PATH": "`A[]` or `E<>`",
    "QUANTIFIER": "`A` or `E`",
}
_TITLE = re.compile(r'[ \t]*(?:["#\n]|\Z)')
_SWALLOWED = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)[ \t]+([^\W\d]\w*)\s*\Z")


def explain_unexpected(
    error: UnexpectedInput, parser: lark.Lark, source: Source, start: int, end: int, rule: str
) -> Diagnostic:
    """Say what was found and what could have stood there.

    Args:
        error: raised by the parser.
        parser: the parser.
        source: the file.
        start: the start in it of the text given to the parser.
        end: its end.
        rule: the start rule.
    """
    place = _place(error, source, start, end)
    accepted, _ = accepted_terminals(parser, source.text[start:end], rule)
    found = place.text
    nameless = found in NAMELESS and _is_demanded(source.text[start : place.start], place)
    nameless = nameless or bool(if_fix(source.text[start : place.start]))
    if found in RESERVED and "NAME" in accepted and not (accepted >= _OPERAND or nameless):
        return names.reserved(place)
    if swallowed := _SWALLOWED.search(source.text, start, place.start):
        number, name = swallowed[1], Span(source, swallowed.start(2), swallowed.end(2))
        if name.text not in unit_table() and name.text not in NOT_UNITS:
            return types.swallowed_name(name, number)
    expected = _in_words(accepted, parser)
    shown = f"`{short(found)}`" if found else "the end of the item"
    message = f"found {shown}" + (f", expected {expected}" if expected else "")
    fix = fix_of(found, accepted, parser, Span(source, start, place.start))
    return finding(syntax.SYNTAX, message, place, fix=fix)


def _is_demanded(before: str, word: Span) -> bool:
    """Whether a word begins what a requirement without a name demands; else it is the name.

    A name stands on the line of `requirement`, with its text or nothing behind it.
    """
    named = re.fullmatch(r"requirement[ \t]+", before) and _TITLE.match(word.source.text, word.end)
    return before.split() == ["requirement"] and not named


def _place(error: UnexpectedInput, source: Source, start: int, end: int) -> Span:
    if isinstance(error, UnexpectedToken) and error.token.type not in ("$END", "UNIT"):
        first = start + (error.token.start_pos or 0)
        return Span(source, first, first + max(len(error.token), 1))
    at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
    if not at_end:  # UNIT matches almost anything, so the word is looked for here
        first = start + (error.pos_in_stream or 0)
        word = re.compile(r"\w+|.", re.DOTALL).match(source.text, first)
        return Span(source, first, word.end() if word else first)
    text = re.sub(r"(?m)#.*$", lambda comment: " " * len(comment[0]), source.text[start:end])
    last = start + len(text.rstrip())
    return Span(source, last, last)


def accepted_terminals(parser: lark.Lark, text: str, rule: str) -> tuple[set[str], bool]:
    """The terminals with which a text could really go on; the list of an error is too long.

    Returns:
        They, and whether the text can be read up to its end.
    """
    interactive: Any = parser.parse_interactive(text, start=rule)
    try:
        interactive.exhaust_lexer()
        read = True
    except UnexpectedInput:
        read = False
    return set(interactive.accepts()), read


def _in_words(accepted: set[str], parser: lark.Lark) -> str:
    rest = set(accepted)
    words = []
    if rest == _DURATION | {"LSQB"}:
        return "a duration such as `3 s`"
    if rest >= _OPERAND:
        words.append("a formula or a number")
        rest -= _OPERAND_ALL
    elif rest >= _VALUE:
        words.append("a number or a name")
        rest -= _OPERAND_ALL
    if "AND" in rest:
        words.append("an operator such as `and`, `or`, `->`, `until`")
        rest -= _INFIX | _ARITHMETIC
    if "THEN" in rest:
        rest -= _CLAUSES  # what has to come is told, not what may stand before it
    if rest >= _CLAUSES:
        words.append("a clause (`source`, `scope`, `let`, …)")
        rest -= _CLAUSES
    if len(rest & {"SPEC", "SIGNAL", "REQUIREMENT"}) == 3:
        return f"an item ({', '.join(f'`{word}`' for word in ITEM_WORDS)})"
    words += sorted(_word(terminal, parser) for terminal in rest if terminal != "$END")
    if "$END" in rest:
        words.append(_WORDS["$END"])
    return " or ".join(words)


def _word(terminal: str, parser: lark.Lark) -> str:
    if terminal in _WORDS:
        return _WORDS[terminal]
    words = words_of(terminal, parser) or [parser.get_terminal(terminal).pattern.value]
    return " or ".join(f"`{word}`" for word in words)
