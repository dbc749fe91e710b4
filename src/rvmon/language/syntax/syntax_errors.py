"""Explains syntax errors: what was found, what could stand there, and how to fix it."""

from __future__ import annotations

import re
from itertools import product
from typing import Any

import lark
from lark.exceptions import UnexpectedInput, UnexpectedToken

from rvmon.diagnostics import Diagnostic, Source, Span
from rvmon.language.rules import finding, names, short, syntax, types
from rvmon.language.syntax.keywords import ITEM_WORDS, NOT_UNITS, RESERVED
from rvmon.texts import nearest
from rvmon.units import SPOKEN, unit_table

COMMENT = "a comment begins with `#`"
_FIX = {
    "≤": "write `<=`",
    "≥": "write `>=`",
    "≠": "write `!=`",
    "→": "write `->`",
    "↔": "write `<->`",
    "∧": "write `and`",
    "∨": "write `or`",
    "¬": "write `not`",
    "□": "write `always`",
    "◇": "write `eventually`",
    '"': "a text ends on the line it starts on, with a second quote",
    "“": 'write straight quotes: "',
    "”": 'write straight quotes: "',
    "'": 'texts are written in double quotes: "',
    "`": "a quoted name ends on the line it starts on, with a second backtick",
    "%": "`%` is a unit and comes after a number",
    ";": "items and clauses need no `;`",
    "/": COMMENT,
    "becomes": "write `rise(…)` for the instant at which something becomes true",
}
_TRIGGER_WORDS = "for `{}` write `upon` (an instant) or `whenever` (as long as it holds)"
NEVER = "for `never` write `always not (…)`"
NAMELESS = RESERVED - frozenset(ITEM_WORDS)
"""Reserved words that may start the formula of a requirement: all but those of items."""
_CLAUSE = re.compile(
    r'requirement\s+(?:[\w.]+|`[^`]+`)\s*(?:"[^"\n]*")?\s*'
    r"(source|rationale|severity|tags|scope|at\s+end|for\s+each|in\s+at|property)"
    r'(?:\s+\w+(?:\s+in(?:\s+\S+)?)?|\s+"[^"]*")?'
)
_LET = "`let` comes after the trigger or the consequent: `upon … let x = … then …`"
_SHARE = "write `in at least 95 % of runs`, or `in at most 5 % of runs`"
_BEGINNINGS = r"(?<![\w.])(?:upon|whenever|then|always|and|or)(?![\w.])|->"
"""Words after which a formula starts."""
_DURATION_OF = r"(?<![\w.])(?:within|for)[ \t]+[\w.]+(?:[ \t]+\w+)?[ \t]*"
_BEHIND = 100  # characters after the unexpected word that patterns see
_Rows = tuple[tuple[str, str, str], ...]
"""Rows of known mistakes: a pattern, a terminal, and the fix.

The pattern is searched in `before\\0word\\0after`: the item up to the unexpected word, that word,
and the text after it. The terminal must be accepted at the word; "" puts no condition. Groups of
the pattern fill the placeholders of the fix.
"""
_CERTAIN: _Rows = (
    # `x < 5 A`: the letter is an operator, not the unit.
    *(
        (
            rf"(?<![\w.])(\d[\d.]*)[ \t]*\0?{sign}\s*\0",
            *("", f"`{sign}` is an operator here: write `{{0}} {SPOKEN[sign]}`"),
        )
        for sign in "AW"
    ),
    # `then not open for 1 s`: the duration comes after its formula.
    (
        rf"\A(?=[^\0]*\0for\0)[^\0]*(?:{_BEGINNINGS}|\()"
        r"\s*([^()\0]*[^\s\0])\s*\0for\0[ \t]+(\d[\d.]*[ \t]*\w+)",
        "",
        "write `held({0}, {1})` for the past, `for {1} ({0})` for the future",
    ),
    (
        rf"\A(?=[^\0]*\0\[\0)[^\0]*(?:{_BEGINNINGS})"
        r"\s*([^\0]*[^\s\0])\s+in\s*\0\[\0\s*([^],]+?)\s*,\s*([^]]+?)\s*\]",
        *("", "`in` takes a list of values: write `({0} >= {1} and {0} <= {2})`"),
    ),
    # `0,5`, `.5` and `3.`
    (r"(?<![\w.])(\d+)\0[.,]\0(\d+)", "", "write `{0}.{1}`"),
    (r"(?<![\w.])\0[.,]\0(\d+)", "", "write `0.{0}`"),
    (r"(?<![\w.])(\d+)\0\.\0", "", "write `{0}.0`"),
    (_DURATION_OF + r"\0[-+*/]\0", "", "a computed duration needs brackets"),
    (_DURATION_OF + r"\0,\0", "", "there is no comma after a duration"),
)
_LIKELY: _Rows = (
    (r'[={,]\s*\0"([^\W\d]\w*)"\0', "NAME", "labels have no quotes: `{0}`"),
    (r"\0=>\0|==\s*\0>\0", "", "write `->` for an implication, `>=` for a comparison"),
    (r"(?<![\w.])never[ \t]+\0[^\0]", "", NEVER),
    (
        r"\Arequirement\s+([\w.]+)\s*\0\0",
        *("", "`{0}` is read as its name; its formula comes after it"),
    ),
    (
        rf"\Arequirement\s+\0({'|'.join(NAMELESS)})\0",
        *("", "its name comes first, and `{0}` is not one: `requirement R1 {0} …`"),
    ),
    (r"\0let\0|(?<![\w.])let[ \t]+\0[^\0]", "", _LET),
    (
        r"\Asignal[^\0]*\0ignore\0",
        *("", "write `ignore NaN` after the type and role, before `stale after`"),
    ),
    ("", "_OF_RUNS", _SHARE),
    (r"\0in\0", "AND", _SHARE),
    (r"([^\W\d]\w*)[ \t]+\0\(\0", "", "a call has no space before its bracket: `{0}(`"),
    (r"\0([AE][\[<][^\0]*)", "LPAR", "put brackets around `{0} …`"),
    ("", "THEN", "the consequent comes after `then`"),
    (r"\Arequirement[^\0]*\0then\0", "", "a trigger comes before `then`: `upon … then …`"),
    (r"/\0\*\0", "", COMMENT),
    (r"\Arequirement\s*\0", "NAME", 'its name comes first: `requirement R1 "text"`'),
    (r"\Asignal\b", "COLON", "a signal has a type, as in `signal x : real [m]`"),
    (
        r"(?<![\w.])(?:after|at)[ \t]+\0([\d.]+\s*[^\W\d]+)\0",
        *("", "for a condition at that instant write `eventually[{0}, {0}] (…)`"),
    ),
    (r"\Aevent\b[^\0]*\0\{\0", "", "fields stand in round brackets, as in `event pick(id: int)`"),
    (r"\Aevent\b", "COLON", "a field has a type, as in `event pick(id: int)`"),
)
_TYPES = {
    "float": "real",
    "double": "real",
    "number": "real",
    "boolean": "bool",
    "integer": "int",
    "string": "{one, another}",
    "enum": "{one, another}",
}


def fix_of(unexpected: str, accepted: set[str], parser: lark.Lark, before: Span) -> str:
    """The fix for a syntax error; empty if none is known.

    `accepted` are the terminals that could stand in the place of `unexpected`, which is empty at
    the end of the item.
    """
    return (
        # Ordered from certain to guessed; the first fix that is found is used.
        if_fix(before.text)
        or _FIX.get(unexpected, "")
        or _row_fix(_CERTAIN, unexpected, accepted, before)
        or _dash_fix(before.text)
        or _clause_fix(unexpected, before.text)
        or _bare_unit_fix(unexpected, before.text)
        or _row_fix(_LIKELY, unexpected, accepted, before)
        or _word_fix(unexpected, accepted, parser, before.text)
        or _decimal_comma(before.text)
    )


def if_fix(before: str) -> str:
    """The fix for an `if` without `else`, which is meant as a trigger; empty if there is none."""
    unfinished = re.search(r"(?<![\w.])if(?![\w.])(?!.*(?<![\w.])else(?![\w.]))", before, re.DOTALL)
    return _TRIGGER_WORDS.format("if") if unfinished else ""


def _dash_fix(before: str) -> str:
    dashed = re.fullmatch(r"requirement\s+([\w.]+(?:-\w+)+)\s*", before)
    if not dashed:
        return ""
    name = dashed[1].replace("-", "_")
    return f"`{dashed[1]}` is not a name: write `{name}`, or quote it: `` `{dashed[1]}` ``"


def _row_fix(rows: _Rows, unexpected: str, accepted: set[str], before: Span) -> str:
    """The fix of the first row that matches; empty if none does."""
    end = before.end + len(unexpected)
    text = f"{before.text}\0{unexpected}\0{before.source.text[end : end + _BEHIND]}"
    for pattern, terminal, fix in rows:
        found = re.search(pattern, text, re.DOTALL)
        if found and (not terminal or terminal in accepted):
            return fix.format(*found.groups())
    return ""


def _bare_unit_fix(unexpected: str, before: str) -> str:
    is_unit = unexpected in unit_table() and re.search(r":\s*(real|int)[ \t]+$", before)
    return f"a unit is written in brackets: `[{unexpected}]`" if is_unit else ""


def _clause_fix(unexpected: str, before: str) -> str:
    """The fix for a clause before the formula, where its first word is mostly read as a name."""
    clause = _CLAUSE.fullmatch(f"{before.rstrip()} {unexpected}")
    return f"a clause, as `{clause[1]} …`, comes after the formula" if clause else ""


def _word_fix(unexpected: str, accepted: set[str], parser: lark.Lark, before: str) -> str:
    """The fix for a word that the language does not have or does not allow here."""
    if not re.fullmatch(r"[^\W\d]\w*", unexpected):
        return ""
    if "LBRACE" in accepted and unexpected.lower() in _TYPES:
        return f"write `{_TYPES[unexpected.lower()]}`"
    phrases = " ".join(phrase for one in accepted for phrase in words_of(one, parser))
    words = re.findall(r"[a-z]{3,}", phrases)
    close = nearest(unexpected, sorted({*words, *ITEM_WORDS}), 0.75)
    if close and close != unexpected:
        return f"did you mean `{close}`?"
    if "AND" not in accepted:
        return ""
    if unexpected in ("within", "for"):
        return f"`{unexpected}` comes before its operand: `{unexpected} 3 s (…)`"
    last = re.search(r"(\w+)\s*$", before)
    if last and last[1].lower() in ("when", "where", "once"):
        return _TRIGGER_WORDS.format(last[1])
    return f"an operator is missing before `{unexpected}`, or there is a word too many"


def _decimal_comma(text: str) -> str:
    comma = re.search(r"(?<![\w.,])(\d+),(\d+)(?![\w.,])", text)
    return f"if a number was meant by `{comma[0]}`, write `{comma[1]}.{comma[2]}`" if comma else ""


_LOOK_AHEAD = re.compile(r"\(\?[!=](?:[^()]|\([^()]*\))*\)")  # of a terminal's pattern


def words_of(terminal: str, parser: lark.Lark) -> list[str]:
    """The words that a terminal of the grammar matches, without signs and single letters.

    >>> from rvmon.language.syntax.parse import grammar
    >>> words_of("RUN_SHARE", grammar()), words_of("CTL", grammar())[:2]
    (['in at least', 'in at most'], ['AG', 'AF'])
    """
    if terminal in ("$END", "NAME", "NUMBER", "CALL", "UNIT", "STRING"):
        return []
    pattern = str(parser.get_terminal(terminal).pattern.value)
    plain = _LOOK_AHEAD.sub("", pattern).replace(r"\s+", " ")
    if letters := re.fullmatch(r"\[([A-Z]+)\]\[([A-Z]+)\]", plain):
        return [*map("".join, product(*letters.groups()))]
    group = re.fullmatch(r"([a-z ]*)\(([a-z|]+)\)", plain)
    words = [group[1] + one for one in group[2].split("|")] if group else plain.split("|")
    return [word for word in words if re.fullmatch(r"[A-Za-z][A-Za-z ]+", word)]


_OPERAND = {"NUMBER", "NAME", "NOT", "TEMPORAL", "MINUS"}
_OPERAND_ALL = _OPERAND | {
    "WITHIN", "FOR", "IMMEDIATELY", "CTL", "PATH", "QUANTIFIER", "TRUTH", "START", "END", "CALL",
    "LPAR", "IF",
}  # fmt: skip
_VALUE = {"NUMBER", "NAME", "CALL", "LPAR", "MINUS"}
_DURATION = {"NUMBER", "NAME", "LPAR", "MINUS"}
_ARITHMETIC = {"PLUS", "TIMES", "DIVIDE"}
_INFIX = {
    "AND", "OR", "XOR", "IFF", "IMPLIES", "INFIX", "LEADS_TO", "COMPARE", "MINUS", "_IN", "NOT",
}  # fmt: skip
_CLAUSES = {
    "TEXT_CLAUSE", "SEVERITY", "TAGS", "LET", "FOR_EACH", "AT_END", "PROPERTY", "SCOPE",
    "RUN_SHARE",
}  # fmt: skip
_WORDS = {
    "NAME": "a name", "NUMBER": "a number", "STRING": 'a text in "quotes"', "UNIT": "a unit",
    "CALL": "a name with `(`", "$END": "the end of the item", "COMPARE": "a comparison",
    "MINUS": "`-`", "UNWANTED": "`ignore` or `illegal`", "RUN_SHARE": "`in at least`",
    "IFF": "`<->`", "IMPLIES": "`->`", "INFIX": "an operator such as `until`",
    "TEMPORAL": "an operator such as `always`", "CTL": "an operator such as `AG`",
    "PATH": "`A[]` or `E<>`", "QUANTIFIER": "`A` or `E`",
}  # fmt: skip
_TITLE = re.compile(r'[ \t]*(?:["#\n]|\Z)')
_SWALLOWED = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)[ \t]+([^\W\d]\w*)\s*\Z")


def explain_unexpected(
    error: UnexpectedInput, parser: lark.Lark, source: Source, start: int, end: int, rule: str
) -> Diagnostic:
    """The finding for a syntax error between `start` and `end` of a file."""
    place = _place(error, source, start, end)
    accepted, _ = accepted_terminals(parser, source.text[start:end], rule)
    unexpected = place.text
    nameless = unexpected in NAMELESS and _is_demanded(source.text[start : place.start], place)
    nameless = nameless or bool(if_fix(source.text[start : place.start]))
    if unexpected in RESERVED and "NAME" in accepted and not (accepted >= _OPERAND or nameless):
        return names.reserved(place)
    # In `within 3 released` the name was read as a unit, so the error comes only after it.
    if swallowed := _SWALLOWED.search(source.text, start, place.start):
        number, name = swallowed[1], Span(source, swallowed.start(2), swallowed.end(2))
        if name.text not in unit_table() and name.text not in NOT_UNITS:
            return types.swallowed_name(name, number)
    expected = _in_words(accepted, parser)
    shown = f"`{short(unexpected)}`" if unexpected else "the end of the item"
    message = f"found {shown}" + (f", expected {expected}" if expected else "")
    fix = fix_of(unexpected, accepted, parser, Span(source, start, place.start))
    return finding(syntax.SYNTAX, message, place, fix=fix)


def _is_demanded(before: str, word: Span) -> bool:
    """Whether a word after `requirement` starts its formula, as the name was left out.

    The word is the name if it stands on the line of `requirement` and only a text may follow it.
    """
    named = re.fullmatch(r"requirement[ \t]+", before) and _TITLE.match(word.source.text, word.end)
    return before.split() == ["requirement"] and not named


def _place(error: UnexpectedInput, source: Source, start: int, end: int) -> Span:
    if isinstance(error, UnexpectedToken) and error.token.type not in ("$END", "UNIT"):
        first = start + (error.token.start_pos or 0)
        return Span(source, first, first + max(len(error.token), 1))
    at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
    if not at_end:  # UNIT matches almost anything, so its token is too long: find the word here
        first = start + (error.pos_in_stream or 0)
        word = re.compile(r"\w+|.", re.DOTALL).match(source.text, first)
        return Span(source, first, word.end() if word else first)
    text = re.sub(r"(?m)#.*$", lambda comment: " " * len(comment[0]), source.text[start:end])
    last = start + len(text.rstrip())
    return Span(source, last, last)


def accepted_terminals(parser: lark.Lark, text: str, rule: str) -> tuple[set[str], bool]:
    """The terminals with which a text could continue, and whether all of the text can be read.

    The list in lark's error is not used: it also has terminals that fail later.
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
        rest -= _CLAUSES  # name the word that must come, not the optional clauses before it
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
