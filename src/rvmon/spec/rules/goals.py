"""Rules on cover goals, coverpoints and crosses."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.nearest import did_you_mean
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Breach, Rule, finding

MOST_COMBINATIONS = 10_000
"""Crosses with more combinations are refused."""

BIN = Rule("RV060", "bin", Severity.ERROR)

CROSS = Rule("RV061", "cross", Severity.ERROR)

EMPTY_BIN = Rule("RV062", "empty-bin", Severity.WARNING)

RULES = (BIN, CROSS, EMPTY_BIN)


bin_without_values = Breach(
    BIN,
    "bin `{}` names no values",
    "write `name: value`, `name: [low, high)`, `name: value => value` or `name: formula`",
)
bin_needs_expression = Breach(
    BIN,
    "`{}` is no formula, and the coverpoint has no expression",
    "write `coverpoint NAME = expression {{…}}`",
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
empty_bin = Breach(
    EMPTY_BIN,
    "no value lies in `{}`: nothing can hit this bin",
    "write the lower bound first; `[` and `]` take a bound in",
)
sampled_apart = Breach(
    CROSS,
    "its coverpoints are looked at `upon` different things",
    "name the instants of the cross: add `upon` to it",
)
unwanted_in_point = Breach(
    BIN, "a coverpoint marks its bins inside the brackets", "write `{{ignore name: values}}`"
)


def no_coverpoint(span: Span, name: str, known: Sequence[str]) -> Diagnostic:
    """A cross over something else."""
    fix = did_you_mean(name, known, "declare it with `coverpoint`")
    return finding(CROSS, f"no coverpoint named `{name}`", span, fix=fix)


same_point = Breach(CROSS, "`{}` stands twice in one cross", "name it once")


too_many_combinations = Breach(
    CROSS,
    f"{{1:,}} combinations are more than {MOST_COMBINATIONS:,}",
    "cross fewer coverpoints, or give them fewer bins",
)
bad_condition = Breach(
    CROSS,
    "`{}` is no condition on bins",
    "write comparisons of coverpoints with their bins: `gaze == no and location != yes`",
)
