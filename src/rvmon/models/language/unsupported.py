"""Parts of UPPAAL's language that are not supported, recognised at the place of an error."""

from __future__ import annotations

import re

from rvmon.diagnostics import Span
from rvmon.models import model_error

Reason = tuple[str, str]  # a message about an unsupported construct, and an alternative

_OUTSIDE: Reason = ("functions from outside are not supported", "write their body out")
_HOOKS: Reason = ("updates around every step are not supported", "write them on the edges")
_DYNAMIC: Reason = (
    "templates that are started by runs are not supported",
    "declare all instances in the system line",
)

_DECLARING: dict[str, Reason] = {
    "hybrid": ("hybrid clocks are not supported", "use a plain clock"),
    "string": ("texts are not supported", "use numbers"), "import": _OUTSIDE, "dynamic": _DYNAMIC,
    "spawn": _DYNAMIC, "before_update": _HOOKS, "after_update": _HOOKS,
}  # fmt: skip
_COMPUTING: dict[str, Reason] = _DECLARING | dict.fromkeys(
    ("break", "continue", "switch"),
    ("break, continue and switch are not supported", "write if and while"),
)
_UPDATING: dict[str, Reason] = _COMPUTING | dict.fromkeys(
    ("if", "else", "for", "while", "do", "return"),
    ("statements are only allowed in functions", "write a function, and call it in the update"),
)
_ASKING: dict[str, Reason] = {
    **dict.fromkeys(
        ("Pr", "simulate"),
        (
            "this form of a statistical query is not supported",
            "write Pr[<=T](<> p), with >= or <= a number for a test, or E[<=T; n](max: e)",
        ),
    ),
    **dict.fromkeys(
        ("control", "strategy", "under", "minE", "maxE", "minPr", "maxPr"),
        ("games and strategies are not supported", "ask for a run with E<>"),
    ),
    **dict.fromkeys(
        ("U", "W", "AU", "EU"),
        ("until takes brackets", "write A[p U q], E[p U q], or (p U q) in a formula of LTL"),
    ),
}
_CALLS = "abs random random_normal random_poisson isnan exp2 log2 cbrt asin acos atan atan2"
"""Functions of UPPAAL on numbers with a fraction that are not supported."""

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_OLD_CONSTANT = re.compile(r"\bconst\s+(\w+)\s+(-?\d+)$")


def type_reason(name: str) -> Reason | None:
    """Why a type of UPPAAL's is not supported; `None` for any other name.

    >>> type_reason("string")[1]
    'use numbers'
    """
    return _DECLARING.get(name)


def refuse_foreign(name: str, span: Span) -> None:
    """Refuse a call of an unsupported function of UPPAAL."""
    if name in _CALLS.split():
        fix = "write it as a function of what there is"
        raise model_error("TA016", f"`{name}` is not supported", span, fix)


def reason_at(text: str, start: int, length: int, rule: str) -> Reason | None:
    """The unsupported construct of UPPAAL's language at the place of a syntax error.

    >>> reason_at("hybrid clock x;", 7, 5, "declarations")[0]
    'hybrid clocks are not supported'
    """
    end = start + length
    found, clause = text[start:end], _clause(text[:end].rstrip(" ;"), rule)
    words = re.findall(r"\w+", clause)
    tables = {"query": _ASKING, "document": _DECLARING, "updates": _UPDATING}
    table = tables.get(rule, _COMPUTING)
    for word in words:
        if word in table:
            return table[word]
    if old := _OLD_CONSTANT.search(clause):
        return "a constant without a type", f"write const int {old[1]} = {old[2]}"
    if found in ("=", ":=") and rule in ("updates", "declarations"):
        return "an assignment is not a value", "write one assignment after the other"
    return None


def without_comments(text: str) -> str:
    """A text with comments replaced by spaces."""
    return _COMMENT.sub(" ", text)


def _clause(text: str, rule: str) -> str:
    """The last statement of a text, or in a `.ta` file its last line, without comments."""
    plain = without_comments(text)
    if rule == "document":
        return plain.rpartition("\n")[2]
    return re.split(r"[;}]", plain)[-1]
