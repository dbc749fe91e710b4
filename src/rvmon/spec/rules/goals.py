"""Rules on cover goals, coverpoints and crosses."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.nearest import did_you_mean
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Breach, Rule, finding

MOST_COMBINATIONS = 10_000
"""Crosses with more combinations are refused."""

BIN = Rule(
    "RV060",
    "bin",
    Severity.ERROR,
    "The values of a bin do not fit its coverpoint.",
    "A bin is a value, a range or a formula of the present and past; without values it is the "
    "label of its own name.",
    """spec demo
signal speed : real [m/s]

coverpoint pace = speed {slow, fast}
""",
    """spec demo
signal speed : real [m/s]

coverpoint pace = speed {slow: [0 m/s, 250 mm/s), fast: [250 mm/s, inf)}
""",
)

CROSS = Rule(
    "RV061",
    "cross",
    Severity.ERROR,
    "A cross names what is no coverpoint, or has a clause that does not fit.",
    "A cross combines the bins of coverpoints; what it ignores is written over their bins.",
    """spec demo
signal gaze_ok, pressure_ok : bool

coverpoint gaze = gaze_ok {yes: true, no: false}
cross both = gaze, pressure_ok
""",
    """spec demo
signal gaze_ok, pressure_ok : bool

coverpoint gaze = gaze_ok {yes: true, no: false}
coverpoint pressure = pressure_ok {yes: true, no: false}
cross both = gaze, pressure
""",
)

RULES = (BIN, CROSS)


bin_without_values = Breach(
    BIN,
    "bin `{}` names no values",
    "write `name: value`, `name: [low, high)`, `name: value => value` or `name: formula`",
)
bin_needs_expression = Breach(
    BIN,
    "`{}` is no formula, and the coverpoint has no expression",
    "write `coverpoint NAME = expression {…}`",
)
looks_ahead = Breach(
    BIN,
    "`{}` speaks of the future, and bins are looked at on the spot",
    "use `once`, `historically`, `since`",
)
bad_goal = Breach(BIN, "`{}` is no count of hits", "write `goal 3`")
bad_weight = Breach(BIN, "`{}` is no weight", "write `weight 2`")
same_value = Breach(
    BIN, "`{}` is where the step began", "a step leads to another value: `idle => moving`"
)
sampled_apart = Breach(
    CROSS,
    "its coverpoints are looked at `upon` different things",
    "name the instants of the cross: add `upon` to it",
)
unwanted_in_point = Breach(
    BIN, "a coverpoint marks its bins inside the brackets", "write `{ignore name: values}`"
)


def no_coverpoint(span: Span, name: str, known: Sequence[str]) -> Diagnostic:
    """A cross over something else."""
    fix = did_you_mean(name, known, "declare it with `coverpoint`")
    return finding(CROSS, f"no coverpoint named `{name}`", span, fix=fix)


def same_point(span: Span, name: str) -> Diagnostic:
    """A cross that names a coverpoint twice."""
    return finding(CROSS, f"`{name}` stands twice in one cross", span, fix="name it once")


def too_many_combinations(span: Span, count: int) -> Diagnostic:
    """A cross that is too large."""
    return finding(
        CROSS,
        f"{count:,} combinations are more than {MOST_COMBINATIONS:,}",
        span,
        fix="cross fewer coverpoints, or give them fewer bins",
    )


bad_condition = Breach(
    CROSS,
    "`{}` is no condition on bins",
    "write comparisons of coverpoints with their bins: `gaze == no and location != yes`",
)
