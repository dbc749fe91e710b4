"""Rules on CTL properties, cover goals, coverpoints and crosses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rvmon.diagnostics import Diagnostic, Severity, Span
from rvmon.language.rules import Breach, Rule, finding, short
from rvmon.texts import did_you_mean

MOST_COMBINATIONS = 10_000
"""Crosses with more combinations are refused."""

BIN = Rule("RV060", "bin", Severity.ERROR)
CROSS = Rule("RV061", "cross", Severity.ERROR)
EMPTY_BIN = Rule("RV062", "empty-bin", Severity.WARNING)


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
    "`{}` refers to the future, and a bin is evaluated at the present instant",
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


PATH_OUTSIDE = Rule("RV050", "path-quantifier", Severity.ERROR)
BARE_TIME = Rule("RV051", "time-without-quantifier", Severity.ERROR)
FOREIGN_NAME = Rule("RV052", "name-of-a-model", Severity.WARNING)
NO_RESPONSE = Rule("RV053", "role-split", Severity.ERROR)
NOT_LINEAR = Rule("RV054", "not-on-one-run", Severity.ERROR)


path_outside = Breach(
    PATH_OUTSIDE,
    "`{}` refers to several runs and belongs into a `property`",
    "for one run write `always` or `eventually`",
)
bare_time = Breach(
    BARE_TIME,
    "`{}` has no path quantifier",
    "write `AF`, `AG`, `EF`, `EG`, `A[φ U ψ]` or `E[φ U ψ]`",
)
next_window = Breach(BARE_TIME, "`AX` and `EX` take no interval", "use `AF` or `EF` with it")
no_path_formula = Breach(
    BARE_TIME,
    "`{}` is no path formula",
    "`A[ ]` and `E[ ]` hold `φ U ψ`; for the others write `A[] φ`, `AF φ`, `E<> φ`",
)
path_in_number = Breach(PATH_OUTSIDE, "a path quantifier stands inside `{}`")


foreign_name = Breach(
    FOREIGN_NAME,
    "`{1}` is no name of this file and is taken for a clock or location of a model",
    "{2}",
)
no_property = Breach(
    NO_RESPONSE,
    "there is no property to derive the monitor from",
    "add a clause `property E<> (…)`",
)
nothing_written = Breach(
    NOT_LINEAR, "there is no property to be monitored", "add a clause `property A[] (…)`"
)


no_goal = Breach(
    NOT_LINEAR, "there is no property that runs should show", "add a clause `property E<> (…)`"
)


reads_model = Breach(
    NOT_LINEAR,
    "`{1}` reads a clock or location of a model, which no run shows",
    "check it with `rvmon verify`, or write it with signals of this file",
)
some_path = Breach(
    NOT_LINEAR,
    "`{}` refers to one of several paths, and a run shows only one",
    "check it with `rvmon verify`; what some run should show is a goal: `cover ID = φ`",
)
not_shown = Breach(
    NOT_LINEAR,
    "`{}` is shown by no single run",
    "as a goal take `E<> φ` or `E[φ U ψ]`; or check it with `rvmon verify`",
)


def not_for_models(found: Diagnostic) -> Diagnostic:
    """The same finding, where the way out is not the model checker either."""
    if found.code != NOT_LINEAR.code or "rvmon verify" not in found.help:
        return found
    fix = "write it for one run; `rvmon verify` does not decide a window that opens later either"
    return replace(found, help=fix)


not_of_a_goal = Breach(
    NOT_LINEAR,
    "`{}` means nothing for `monitor as cover`: a goal has no attempts",
    "remove the clause",
)
choice_of_paths = Breach(
    NOT_LINEAR,
    "`{}` leaves open which of the two the paths fulfil",
    "let `p` choose: `(p and φ) or (not p and ψ)`; or check it with `rvmon verify`",
)
not_on_one_path = Breach(
    NOT_LINEAR,
    "`{}` means another thing on all paths together than on each of them",
    "let what comes be about one instant; or check it with `rvmon verify`",
)
no_response = Breach(
    NO_RESPONSE,
    "a response monitor is derived from `E<> (p and q and …)` over the names of this file",
    "write the requirement with `upon` and `then`",
)


def mixed_roles(span: Span, roles: Mapping[str, str]) -> Diagnostic:
    """A conjunct that reads inputs and outputs, or nothing at all."""
    listed = ", ".join(f"`{name}` is {role}" for name, role in roles.items())
    text = short(span.text)
    message = f"`{text}` mixes roles: {listed}" if roles else f"`{text}` reads no signal"
    return finding(NO_RESPONSE, message, span, fix="write the requirement with `upon` and `then`")


no_role = Breach(NO_RESPONSE, "`{1}` is declared neither `input` nor `output`", "declare its role")
no_output = Breach(
    NO_RESPONSE,
    "the property reads no output: the system has no obligation",
    "declare the signals that the system sets as `output`",
)
