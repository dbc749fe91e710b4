"""Parts of UPPAAL's language that are not supported, recognised where reading stops."""

from __future__ import annotations

import re

Reason = tuple[str, str]
"""What is not supported, and what to do instead."""

_STATEMENTS: Reason = (
    "statements are not supported",
    "an update is a list of assignments: put conditions on edges",
)
_GAMES: Reason = ("games and strategies are not supported", "ask for a run with E<>")
_EXTREMES: Reason = ("extreme values are not computed", "ask whether A[] x <= bound holds")
_STATISTICS: Reason = (
    "this form of a statistical query is not supported",
    "write Pr[<=T](<> p), with >= or <= a number for a test, or E[<=T; n](max: e)",
)
_UNTIL: Reason = (
    "until takes brackets",
    "write A[p U q], E[p U q], or (p U q) in a formula of LTL",
)
_HOOKS: Reason = ("updates around every step are not supported", "write them on the edges")
_OUTSIDE: Reason = ("functions from outside are not supported", "write their body out")
_DYNAMIC: Reason = (
    "templates that are started by runs are not supported",
    "declare all instances in the system line",
)
_FRACTIONS: Reason = (
    "numbers are whole: floating point is not supported",
    "choose a finer unit of time",
)
_RATES: Reason = (
    "rates of clocks (stop-watches, hybrid models) are not supported",
    "all clocks run all the time: reset one where it would be stopped",
)
_TEXTS: Reason = ("texts are not supported", "use numbers")
_PRIORITIES: Reason = (
    "priorities are not supported",
    "order the steps by guards or by committed locations",
)
_BITS: Reason = ("operators on bits, minimum and maximum are not supported", "write them out")

_DECLARING: dict[str, Reason] = {
    "struct": ("records (struct) are not supported", "declare one variable for each field"),
    "scalar": ("scalar sets are not supported", "use int[0, n - 1]: the answers are the same"),
    "meta": ("meta variables are not supported", "declare a plain variable"),
    "hybrid": ("hybrid clocks are not supported", "use a plain clock"),
    "double": _FRACTIONS,
    "string": _TEXTS,
    "import": _OUTSIDE,
    "dynamic": _DYNAMIC,
    "spawn": _DYNAMIC,
    "before_update": _HOOKS,
    "after_update": _HOOKS,
}
_COMPUTING: dict[str, Reason] = {
    **_DECLARING,
    "priority": _PRIORITIES,
    "sum": ("sums over a type are not supported", "write the terms out"),
    **dict.fromkeys(("if", "else", "for", "while", "do", "return", "switch"), _STATEMENTS),
}
_ASKING: dict[str, Reason] = {
    **dict.fromkeys(("Pr", "simulate"), _STATISTICS),
    **dict.fromkeys(("sup", "inf", "bounds"), _EXTREMES),
    **dict.fromkeys(("control", "strategy", "under", "minE", "maxE", "minPr", "maxPr"), _GAMES),
    **dict.fromkeys(("U", "W", "AU", "EU"), _UNTIL),
}
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_OLD_CONSTANT = re.compile(r"\bconst\s+(\w+)\s+(-?\d+)$")
_BIT_OPERATOR = re.compile(r"<<|>>|<\?|>\?|[&|^~]")
_FRACTION = re.compile(r"\d+\.\d+$")


def type_reason(name: str) -> Reason | None:
    """Why there is no type of a name, if it is one of UPPAAL's.

    >>> type_reason("double")[1]
    'choose a finer unit of time'
    """
    return _DECLARING.get(name)


def reason_at(text: str, start: int, length: int, rule: str) -> Reason | None:
    """What of UPPAAL's language a text uses at the place where it could not be read.

    >>> reason_at("meta int i;", 5, 3, "declarations")[0]
    'meta variables are not supported'
    """
    end = start + length
    found, clause = text[start:end], _clause(text[:end], rule)
    words = re.findall(r"\w+", clause)
    table = {"query": _ASKING, "document": _DECLARING}.get(rule, _COMPUTING)
    for word in words:
        if word in table:
            return table[word]
    if old := _OLD_CONSTANT.search(clause):
        return "a constant without a type", f"write const int {old[1]} = {old[2]}"
    if _FRACTION.search(clause):
        return _FRACTIONS
    if rule == "system" and found in ("<", ">"):
        return _PRIORITIES
    if rule in ("declarations", "system") and found == "(":
        return "functions are not supported", "write the body out where it is used"
    if rule == "updates":
        if found in ("", ",") and clause.rstrip(" ,\n").endswith(")"):
            return "functions are not supported", "write the assignments of its body out"
        if found == "=":
            return "an assignment is no value", "write one assignment after the other"
    if found == "'":
        return _RATES
    if found == "{" and rule != "document":
        return _STATEMENTS
    if rule == "expression" and found == ",":
        return "a list of conditions", "join them by &&"
    if _BIT_OPERATOR.search(text[max(0, start - 1) : start + 2]) and rule != "document":
        return _BITS
    return None


def _clause(text: str, rule: str) -> str:
    """The last statement of a text, without comments; in a `.ta` file its last line."""
    plain = _COMMENT.sub(" ", text)
    if rule == "document":
        return plain.rpartition("\n")[2]
    return re.split(r"[;}]", plain)[-1]
