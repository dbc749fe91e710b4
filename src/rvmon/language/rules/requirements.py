"""Rules on requirements, properties, cover goals, coverpoints and crosses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rvmon.diagnostics import Diagnostic, Severity, Span
from rvmon.language.rules import Breach, Rule, finding, short
from rvmon.texts import did_you_mean

NO_VALUE = Rule("RV028", "no-value-to-capture", Severity.WARNING)
AT_TRIGGER = Rule("RV047", "false-at-trigger", Severity.WARNING)
AT_FIRST = Rule("RV048", "false-at-first", Severity.WARNING)
ONCE_CAPTURED = Rule("RV049", "captured-once", Severity.WARNING)

no_value = Breach(
    NO_VALUE,
    "`{0}` has no value unless `{1}` occurs at the trigger, which does not require it",
    "let `{1}` trigger it: `upon {1} and …`",
)


def false_at_trigger(span: Span, part: str, escape: str, fix: str) -> Diagnostic:
    """The consequent contradicts its trigger."""
    unless = f" unless `{short(escape)}` holds at that very instant" if escape else ""
    return finding(
        AT_TRIGGER,
        f"`{short(part)}` is false at the trigger itself, by its condition: it fails there"
        + (unless or " each time"),
        span,
        fix=fix,
    )


false_at_first = Breach(AT_FIRST, "`{0}` is false {1}, whatever comes: it fails there", "{2}")
"""A part required from the start on that cannot hold then. Arguments: the instant, the fix."""


def captured_once(span: Span, trigger: str) -> Diagnostic:
    """A capture under `whenever`; `trigger` is the condition, empty if it always holds."""
    when = f"of each stretch of `{short(trigger)}`" if trigger else "of the run"
    instead = f"`upon {short(trigger)} then …`" if trigger else "`upon … then …`"
    return finding(
        ONCE_CAPTURED,
        f"`{short(span.text)}` is captured once, at the first instant {when}",
        span,
        fix=f"write {instead}, which starts there and captures then",
    )


FUTURE_TRIGGER = Rule("RV040", "future-in-trigger", Severity.ERROR)
END_NOT_ALONE = Rule("RV041", "end-not-alone", Severity.ERROR)
ONE_INSTANT = Rule("RV042", "one-instant", Severity.WARNING)
MIXED_TRIGGER = Rule("RV043", "pulse-or-level", Severity.WARNING)
DOUBLE_CLAUSE = Rule("RV044", "double-clause", Severity.ERROR)
UNKNOWN_POLICY = Rule("RV045", "unknown-policy", Severity.ERROR)
NEVER_READ = Rule("RV046", "never-read", Severity.WARNING)
RUN_SHARE = Rule("RV075", "bad-run-share", Severity.ERROR)

future_trigger = Breach(
    FUTURE_TRIGGER,
    "`{}` refers to the future, and a trigger has to be known at once",
    "move it after `then`, or use `once`, `historically`, `since`",
)
end_not_alone = Breach(
    END_NOT_ALONE,
    "`end` can only stand alone, as `upon end`",
    "write `upon end` and put the rest after `then`",
)
end_in_scope = Breach(
    END_NOT_ALONE,
    "`upon end` takes no scope: the end of the run may lie outside of it",
    "state the condition for the end in the consequent",
)
one_instant = Breach(
    ONE_INSTANT,
    "`{}` is checked at one instant only",
    "write for how long or until when (`within D`, `for D`), or `immediately {}`",
)
bare_instant = Breach(
    ONE_INSTANT,
    "`{0}` is checked at one instant only, the start of the run",
    "did you mean `always ({0})`? If the start is meant, write `immediately ({0})`",
)
mixed_trigger = Breach(
    MIXED_TRIGGER,
    "`{0}` is an event and `{1}` a state: while the state holds, the event triggers nothing",
    "write `rise({1})`, or make two requirements",
)
"""A disjunction of an event and a state. Arguments: the places of both, the text of the state."""

double_clause = Breach(
    DOUBLE_CLAUSE, "a requirement has one `{1}` clause", "join them, or remove one", "first here"
)


def unknown_policy(span: Span, policies: Sequence[str]) -> Diagnostic:
    """A policy that does not exist."""
    fix = did_you_mean(span.text, policies, f"there are {', '.join(policies)}")
    return finding(UNKNOWN_POLICY, f"no policy named `{short(span.text)}`", span, fix=fix)


bad_run_share = Breach(
    RUN_SHARE,
    "`{}` is not a percentage between 0 and 100",
    "write `in at least 95 % of runs`; for all runs leave the clause out",
)
never_read = Breach(
    NEVER_READ,
    "{1} `{2}` is read by no requirement",
    "remove it, or look for the requirement that should read it",
)
"""A declared name that nothing reads. Arguments: `signal` or `event`, and the name."""

MOST_COMBINATIONS = 10_000  # crosses with more combinations are refused

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
    "`{}` is not a formula, and the coverpoint has no expression",
    "write `coverpoint NAME = expression {{…}}`",
)
looks_ahead = Breach(
    BIN,
    "`{}` refers to the future, and a bin is evaluated at the present instant",
    "use `once`, `historically`, `since`",
)
bad_goal = Breach(BIN, "`{}` is not a number of hits", "write `goal 3`")
bad_weight = Breach(BIN, "`{}` is not a weight", "write `weight 2`")
same_value = Breach(
    BIN, "`{}` is where the step started", "a step leads to another value: `idle => moving`"
)
empty_bin = Breach(
    EMPTY_BIN,
    "no value lies in `{}`: nothing can hit this bin",
    "write the lower bound first; `[` and `]` take a bound in",
)
sampled_apart = Breach(
    CROSS,
    "its coverpoints are sampled `upon` different formulas",
    "name the instants of the cross: add `upon` to it",
)
unwanted_in_point = Breach(
    BIN, "a coverpoint marks its bins inside the brackets", "write `{{ignore name: values}}`"
)


def no_coverpoint(span: Span, name: str, known: Sequence[str]) -> Diagnostic:
    """A cross over a name that is not a coverpoint."""
    fix = did_you_mean(name, known, "declare it with `coverpoint`")
    return finding(CROSS, f"no coverpoint named `{name}`", span, fix=fix)


same_point = Breach(CROSS, "`{}` occurs twice in one cross", "name it once")
too_many_combinations = Breach(
    CROSS,
    f"{{1:,}} combinations are more than {MOST_COMBINATIONS:,}",
    "cross fewer coverpoints, or give them fewer bins",
)
bad_condition = Breach(
    CROSS,
    "`{}` is not a condition on bins",
    "write comparisons of coverpoints with their bins: `gaze == no and location != yes`",
)

PATH_OUTSIDE = Rule("RV050", "path-quantifier", Severity.ERROR)
BARE_TIME = Rule("RV051", "time-without-quantifier", Severity.ERROR)
FOREIGN_NAME = Rule("RV052", "name-of-a-model", Severity.WARNING)
NO_RESPONSE = Rule("RV053", "role-split", Severity.ERROR)
NOT_LINEAR = Rule("RV054", "not-on-one-run", Severity.ERROR)

path_outside = Breach(
    PATH_OUTSIDE,
    "`{}` refers to several runs and belongs in a `property`",
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
    "`{}` is not a path formula",
    "`A[ ]` and `E[ ]` contain `φ U ψ`; for the others write `A[] φ`, `AF φ`, `E<> φ`",
)
path_in_number = Breach(PATH_OUTSIDE, "there is a path quantifier inside `{}`")
foreign_name = Breach(
    FOREIGN_NAME,
    "`{1}` is not declared in this file and is taken for a clock or location of a model",
    "{2}",
)
no_property = Breach(
    NO_RESPONSE,
    "there is no property to derive the monitor from",
    "add a clause `property E<> (…)`",
)
nothing_written = Breach(
    NOT_LINEAR, "there is no property to monitor", "add a clause `property A[] (…)`"
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
    "no single run can show `{}`",
    "as a goal take `E<> φ` or `E[φ U ψ]`; or check it with `rvmon verify`",
)


def not_for_models(found: Diagnostic) -> Diagnostic:
    """The same finding without the advice to use `rvmon verify`, which cannot check it either."""
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
    "`{}` leaves open which of the two the paths satisfy",
    "let `p` choose: `(p and φ) or (not p and ψ)`; or check it with `rvmon verify`",
)
not_on_one_path = Breach(
    NOT_LINEAR,
    "`{}` means something else on all paths together than on each single one",
    "let each operand refer to one instant only; or check it with `rvmon verify`",
)
no_response = Breach(
    NO_RESPONSE,
    "a response monitor is derived from `E<> (p and q and …)` over the names of this file",
    "write the requirement with `upon` and `then`",
)


def mixed_roles(span: Span, roles: Mapping[str, str]) -> Diagnostic:
    """A conjunct that reads both inputs and outputs, or no signal at all."""
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
