"""Rules on cover goals, coverpoints and crosses."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.nearest import did_you_mean
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Rule, finding
from rvmon.spec.rules.syntax import short

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
    "A cross combines the bins of coverpoints; what it ignores is said over their bins.",
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


def bin_without_values(span: Span) -> Diagnostic:
    """A bin that has to say what it holds."""
    return finding(
        BIN,
        f"bin `{short(span.text)}` does not say which values it holds",
        span,
        mend="write `name: value`, `name: [low, high)`, `name: value => value` or `name: formula`",
    )


def bin_needs_expression(span: Span) -> Diagnostic:
    """A value or range in a coverpoint without an expression."""
    return finding(
        BIN,
        f"`{short(span.text)}` is no formula, and the coverpoint has no expression",
        span,
        mend="write `coverpoint NAME = expression {…}`",
    )


def looks_ahead(span: Span) -> Diagnostic:
    """A formula of the future in a bin or sampling clause."""
    return finding(
        BIN,
        f"`{short(span.text)}` speaks of the future, and bins are looked at on the spot",
        span,
        mend="use `once`, `historically`, `since`",
    )


def bad_goal(span: Span) -> Diagnostic:
    """A goal that is no count."""
    return finding(BIN, f"`{short(span.text)}` is no count of hits", span, mend="write `goal 3`")


def bad_weight(span: Span) -> Diagnostic:
    """A weight that is no whole number."""
    return finding(BIN, f"`{short(span.text)}` is no weight", span, mend="write `weight 2`")


def same_value(span: Span) -> Diagnostic:
    """A step from a value to itself."""
    return finding(
        BIN,
        f"`{short(span.text)}` is where the step began",
        span,
        mend="a step leads to another value: `idle => moving`",
    )


def sampled_apart(span: Span) -> Diagnostic:
    """A cross of coverpoints that are looked at in different places."""
    return finding(
        CROSS,
        "its coverpoints are looked at `upon` different things",
        span,
        mend="say where the cross is: add `upon` to it",
    )


def unwanted_in_point(span: Span) -> Diagnostic:
    """`ignore φ` behind the bins of a coverpoint."""
    return finding(
        BIN,
        "a coverpoint marks its bins inside the brackets",
        span,
        mend="write `{ignore name: values}`",
    )


def no_coverpoint(span: Span, name: str, known: Sequence[str]) -> Diagnostic:
    """A cross over something else."""
    mend = did_you_mean(name, known, "declare it with `coverpoint`")
    return finding(CROSS, f"no coverpoint named `{name}`", span, mend=mend)


def same_point(span: Span, name: str) -> Diagnostic:
    """A cross that names a coverpoint twice."""
    return finding(CROSS, f"`{name}` stands twice in one cross", span, mend="name it once")


def too_many_combinations(span: Span, count: int) -> Diagnostic:
    """A cross that is too large."""
    return finding(
        CROSS,
        f"{count:,} combinations are more than {MOST_COMBINATIONS:,}",
        span,
        mend="cross fewer coverpoints, or give them fewer bins",
    )


def bad_condition(span: Span) -> Diagnostic:
    """A condition of a cross that is more than bins and connectives."""
    return finding(
        CROSS,
        f"`{short(span.text)}` is no condition on bins",
        span,
        mend="write comparisons of coverpoints with their bins: `gaze == no and location != yes`",
    )
