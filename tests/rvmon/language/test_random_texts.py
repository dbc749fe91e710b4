"""Random texts of the grammar are readable and varied, and formatting keeps their meaning."""

import random
from collections import defaultdict
from functools import cache

import pytest

from rvmon.diagnostics import Source, Span
from rvmon.language.formatter import format_text, pieces_of
from rvmon.language.rules import Findings
from rvmon.language.syntax.parse import grammar, parse_spec

LONGEST = 30
"""Choices of rules up to so many are free; then the shortest rules end the item."""

LOOKS = {
    "NAME": ("p", "q", "x", "y", "n", "e", "f", "state", "idle", "near", "T", "pick.id", "new"),
    "NUMBER": ("0", "1", "3 s", "200 ms", "0.5 s", "5 cm", "1e-3 m", "2 m/s", "50 %", "7"),
    "UNIT": ("m", "m/s", "N", "%"),
    "STRING": ('"text"', '""', '"a \\" b"', '"# no comment"'),
    "CALL": ("rise(", "held(", "age(", "known(", "prev(", "max(", "soon(", "abs(", "changed("),
    "COMPARE": ("<", "<=", ">", ">=", "==", "!=", "="),
    "INFIX": ("until", "since", "unless", "weak until", "R", "M", "U", "S", "W"),
    "TEMPORAL": ("next", "eventually", "always", "previous", "once", "historically", "F", "H"),
    "CTL": ("AG", "EF", "AX", "EG"),
    "PATH": ("A[]", "E<>", "A<>", "E[]"),
    "QUANTIFIER": ("A", "E"),
    "TRUTH": ("true", "false"),
    "NOT": ("not", "!"),
    "AND": ("and", "&", "&&"),
    "OR": ("or", "|", "||"),
    "IMPLIES": ("->", "implies"),
    "IFF": ("<->", "iff"),
    "LEADS_TO": ("-->",),
    "INFINITE": ("inf", "∞"),
    "ROLE": ("input", "output"),
    "IGNORE_NAN": ("ignore NaN", "ignore  NaN"),
    "UNWANTED": ("ignore", "illegal"),
    "TEXT_CLAUSE": ("source", "rationale"),
    "MINUS": ("-",),
    "RUN_SHARE": ("in at least", "in at most"),
    "_OF_RUNS": ("of runs",),
}
"""What a terminal may look like; all others look like their name, or are one fixed sign."""

GAPS = (" ", " ", " ", "  ", "\n    ", " # note\n  ")


def random_item(rng):
    """A random text of the grammar; its names and types often do not fit."""
    rules, shortest = _rules()
    waiting = ["requirement" if rng.random() < 0.6 else "item"]
    free = rng.randint(3, LONGEST)
    text = before = ""
    while waiting:
        symbol = waiting.pop()
        if symbol in rules:
            low = min(_depth(rule, shortest) for rule in rules[symbol])
            short = [rule for rule in rules[symbol] if _depth(rule, shortest) == low]
            waiting += reversed(rng.choice(rules[symbol] if free > 0 else short))
            free -= len(rules[symbol]) > 1
            continue
        if before == "NUMBER" and symbol in ("NAME", "CALL"):
            text += "\n    "  # directly after the number it would be its unit
        elif text and before != "CALL":
            text += rng.choice(GAPS) if rng.random() < 0.3 else " "
        text += rng.choice(_looks(symbol))
        before = symbol
    return f"{text}\n"


def _depth(rule, shortest):
    return max((shortest[part] for part in rule), default=0)


@cache
def _rules():
    """The expansions of each rule, and the depth of the shortest text of each symbol."""
    rules = defaultdict(list)
    for rule in grammar().rules:
        rules[rule.origin.name].append(tuple(symbol.name for symbol in rule.expansion))
    parts = {symbol for own in rules.values() for rule in own for symbol in rule}
    shortest = dict.fromkeys(parts - rules.keys(), 0)
    while len(shortest) < len({*shortest, *rules}):
        for name, own in rules.items():
            known = [_depth(rule, shortest) + 1 for rule in own if shortest.keys() >= {*rule}]
            if known:
                shortest[name] = min(known)
    return dict(rules), shortest


def _looks(terminal):
    if terminal in LOOKS:
        return LOOKS[terminal]
    pattern = grammar().get_terminal(terminal).pattern
    return (pattern.value,) if pattern.type == "str" else (terminal.lower().replace("_", " "),)


def syntax_of(text):
    """The syntax tree of a text without places; `None` if it cannot be read."""
    findings = Findings()
    parsed = parse_spec(Source("<string>", text), findings)
    return None if findings.diagnostics else _bare(parsed.items)


def _bare(node):
    match node:
        case Span():
            return "a place"
        case tuple():
            return tuple(map(_bare, node))
        case _ if hasattr(type(node), "__match_args__"):
            kept = (_bare(getattr(node, name)) for name in type(node).__match_args__)
            return (type(node).__name__, *kept)
        case _:
            return node


@pytest.mark.slow
def test_random_texts_are_readable_and_formatting_keeps_their_meaning():
    """The parser reads all of them but those that need brackets."""
    missing = {terminal.name for terminal in grammar().terminals} - {*grammar().ignore_tokens}
    made, read, before = 0, 0, ""
    while missing or made < 200:
        text = random_item(random.Random(f"2/{made}"))
        made += 1
        assert made < 4_000, missing
        if syntax_of(text) is None:
            continue
        read += 1
        missing -= {piece.kind for piece in pieces_of(text)[0]}
        if read < 50:
            whole = before + text
            once = format_text(whole)
            assert syntax_of(once) == syntax_of(whole)
            assert format_text(once) == once
            assert once.count("# note") == whole.count("# note")
        before = text
    assert read > made / 2


def test_syntax_has_no_places():
    """Texts that differ in layout have the same tree; a bracket or another word changes it."""
    first = syntax_of("requirement R always (p -> F q)")
    assert first is not None
    assert first == syntax_of("requirement R\n  always (p -> # note\n  eventually q)\n")
    assert first != syntax_of("requirement R always (p -> F (q))")
    assert syntax_of("requirement R always (") is None
