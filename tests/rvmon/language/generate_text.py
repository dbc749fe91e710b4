"""Random texts by the grammar of specifications, and what texts say apart from their layout."""

from collections import defaultdict
from collections.abc import Hashable, Mapping, Sequence
from functools import cache
from typing import Any

from rvmon.diagnostics import Source, Span
from rvmon.language.rules import Findings
from rvmon.language.syntax.parse import grammar, parse_spec
from rvmon.testing.generate import Rng, chance, pick

HEAD = """spec demo
time sampled
signal p, q : bool input
signal x, y : real [m] output stale after 1 s
signal n : int
signal state : {idle, moving, stopped}
event e, f
event pick(id: int, at: real [m])
const T = 3 s
define soon(a, d) = within d a
define near = x < 50 cm
"""
"""Declares the names that random items use."""

LONGEST = 30
"""Choices of rules up to so many are free; then the shortest rules end the item."""

_SAMPLES: Mapping[str, Sequence[str]] = {
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

_GAPS = (" ", " ", " ", "  ", "\n    ", " # note\n  ")


def random_text(rng: Rng, items: int = 1) -> str:
    """A text of the language by its grammar; its names and types often do not fit.

    Args:
        rng: decides.
        items: so many beside the fixed head.
    """
    return HEAD + "".join(_item(rng) + "\n" for _ in range(items))


def syntax_of(text: str) -> Hashable | None:
    """What a text says, without places and layout; `None` if it cannot be read.

    >>> syntax_of("event  a") == syntax_of("event a  # same")
    True
    """
    findings = Findings()
    parsed = parse_spec(Source("<string>", text), findings)
    return None if findings.diagnostics else _bare(parsed.items)


def _bare(node: Any) -> Hashable:
    match node:
        case Span():
            return "a place"
        case tuple():
            return tuple(map(_bare, node))
        case _ if hasattr(type(node), "__match_args__"):
            kept = (_bare(getattr(node, name)) for name in type(node).__match_args__)
            return (type(node).__name__, *kept)
        case _:
            hashable: Hashable = node
            return hashable


def _item(rng: Rng) -> str:
    rules, shortest = _rules()
    tokens: list[tuple[str, str]] = []
    waiting = ["requirement" if chance(rng, 60) else "item"]
    free = rng.randint(3, LONGEST)
    while waiting:
        symbol = waiting.pop()
        if symbol not in rules:
            tokens.append((symbol, pick(rng, _looks(symbol))))
            continue
        low = min(_depth(rule, shortest) for rule in rules[symbol])
        short = [rule for rule in rules[symbol] if _depth(rule, shortest) == low]
        waiting += reversed(pick(rng, rules[symbol] if free > 0 else short))
        free -= len(rules[symbol]) > 1
    text = ""
    before = ""
    for kind, shown in tokens:
        if before == "NUMBER" and kind in ("NAME", "CALL"):
            text += "\n    "  # beside the number it would be its unit
        elif text and before != "CALL":
            text += pick(rng, _GAPS) if chance(rng, 30) else " "
        text += shown if kind != "NAME" else _name(rng, before, shown)
        before = before if kind == "COLON" and before == "AT_END" else kind
    return text


def _name(rng: Rng, before: str, shown: str) -> str:
    """A name that fits behind a word, if only some do."""
    match before:
        case "REQUIREMENT" | "SIGNAL" | "EVENT" | "COVER" | "COVERPOINT" | "CROSS":
            return f"new{rng.randint(1, 999)}"
        case "CONST" | "DEFINE":
            return f"made{rng.randint(1, 999)}"
        case "AT_END":
            return pick(rng, ("strict", "weak", "pass", shown))
        case "WITHIN" | "FOR":
            return pick(rng, ("T", shown))
        case _:
            return shown


def _depth(rule: Sequence[str], shortest: Mapping[str, int]) -> int:
    return max((shortest[part] for part in rule), default=0)


@cache
def _rules() -> tuple[dict[str, list[tuple[str, ...]]], dict[str, int]]:
    """The expansions of each rule, and how deep the shortest text of each symbol is."""
    rules: dict[str, list[tuple[str, ...]]] = defaultdict(list)
    for rule in grammar().rules:
        rules[rule.origin.name].append(tuple(symbol.name for symbol in rule.expansion))
    shortest: dict[str, int] = {
        symbol: 0
        for own in rules.values()
        for rule in own
        for symbol in rule
        if symbol not in rules
    }
    while len(shortest) < len({*shortest, *rules}):
        for name, own in rules.items():
            known = [_depth(rule, shortest) + 1 for rule in own if all(p in shortest for p in rule)]
            if known:
                shortest[name] = min(known)
    return dict(rules), shortest


def _looks(terminal: str) -> Sequence[str]:
    if terminal in _SAMPLES:
        return _SAMPLES[terminal]
    pattern = grammar().get_terminal(terminal).pattern
    return (pattern.value,) if pattern.type == "str" else (terminal.lower().replace("_", " "),)
