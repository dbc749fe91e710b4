"""Rules on types and units, durations, intervals and operators of time."""

from __future__ import annotations

from rvmon.diagnostics import Diagnostic, Severity, Span
from rvmon.language.rules import Breach, Rule, finding, short

WRONG_TYPE = Rule("RV020", "wrong-type", Severity.ERROR)
WRONG_ARGUMENTS = Rule("RV021", "wrong-arguments", Severity.ERROR)
UNIT_MISMATCH = Rule("RV022", "unit-mismatch", Severity.ERROR)
MISSING_UNIT = Rule("RV023", "missing-unit", Severity.ERROR)
UNKNOWN_UNIT = Rule("RV024", "unknown-unit", Severity.ERROR)
OUT_OF_RANGE = Rule("RV025", "number-out-of-range", Severity.ERROR)
LABELS = Rule("RV026", "label-use", Severity.ERROR)
IGNORED_NAN = Rule("RV027", "nan-of-no-real", Severity.ERROR)


def ignored_nan(span: Span, kind: str) -> Diagnostic:
    """`ignore NaN` on a signal that is never NaN; `kind` is the kind of the signal."""
    shown = "with labels" if kind == "label" else f"of type `{kind}`"
    return finding(
        IGNORED_NAN,
        f"a signal {shown} is never NaN",
        span,
        fix="remove `ignore NaN`, or declare the signal `real`",
    )


def needs_formula(span: Span, kind: str) -> Diagnostic:
    """A number or label where a formula is needed; `kind` is `a number` or `a label`."""
    text = short(span.text)
    fix = f"compare it, as in `{text} > 0`" if kind == "a number" else ""
    if kind == "a label":
        fix = "compare it with a label by `==`"
    return finding(WRONG_TYPE, f"`{text}` is {kind}, expected a formula", span, fix=fix)


needs_number = Breach(
    WRONG_TYPE,
    "`{}` is true or false, expected a number",
    "combine formulas by `and`, `or`, `->`, `<->`",
)
compared_truth = Breach(
    WRONG_TYPE,
    "`{}` is true or false and is not compared",
    "write `p` for `p == true`, `not p` for `p == false`, `p <-> q` for `p == q`",
)
age_alone = Breach(
    WRONG_TYPE,
    "`{}` can only be compared with a constant duration, by < <= > >=",
    "write `{} > 200 ms`",
)
now_alone = Breach(
    WRONG_TYPE,
    "found `{}`, expected a comparison of `now` with a duration, by < <= > >=",
    "with `let t0 = now` write `now - t0 <= x` or `now <= t0 + x`; the time since an event is "
    "its age: `age(e) > 3 s`",
)
moves_beside = Breach(
    WRONG_TYPE,
    "`{}` moves between samples along more than one window, or through more than `+ - * /` and "
    "constants, so the tick at which it flips cannot be computed",
    "bring one window alone to one side; `mean(x, D) - mean(y, D)` is `mean(x - y, D)`; "
    "on a clock, `time sampled every 10 ms`, any expression is evaluated at each position",
)
captured_moving = Breach(
    WRONG_TYPE,
    "`{}` moves between samples and cannot be captured",
    "compare with it in the consequent, or evaluate on a clock: `time sampled every 10 ms`",
)
window_in_window = Breach(
    WRONG_TYPE,
    "`{}` has a window of its own and cannot be measured over another one",
    "measure a comparison with it: `duration(mean(x, 1 s) > 2, 10 s)`",
)
limit_of_event = Breach(
    WRONG_TYPE,
    "`{}` has a value only while its event occurs, but a limit needs one throughout",
    "capture it: `let limit = e.x`",
)
sum_of_instances = Breach(
    WRONG_TYPE,
    "`{}` does not decide for each occurrence whether it counts, but `for each` may see several at "
    "one instant",
    "join comparisons of its fields by `and`: `sum(if e.k == k and e.ok then e.x else 0, D)`",
)
variance_moves = Breach(
    WRONG_ARGUMENTS,
    "`{}` moves along a curve between samples, so the tick at which it crosses a bound cannot be "
    "computed",
    "measure updates, `variance(last(20, x))`, or a field, `variance(e.x, 10 s)`",
)
last_alone = Breach(
    WRONG_TYPE,
    "`{}` are several values, expected one",
    "say how to combine them: `mean(last(5, x)) <= 2`, `count(last(8, x > 1)) >= 5`",
)
last_count = Breach(
    WRONG_ARGUMENTS, "`{0}` is not a whole number from 1 to {1:,}", "write `last(5, x)`"
)
last_of_several = Breach(
    WRONG_ARGUMENTS,
    "`{}` does not read exactly one signal or event, whose updates are counted",
    "write `last(5, x)`, `last(8, beat.ms < 500)`",
)
two_windows = Breach(
    WRONG_ARGUMENTS, "`{}` has two windows", "leave out the duration, or `last` or `since trigger`"
)
since_no_trigger = Breach(
    WRONG_ARGUMENTS,
    "`{}` is counted from a trigger, and there is none here",
    "use it in the consequent: `upon e then always count(f since trigger) <= 3`",
)
not_of_last = Breach(
    WRONG_ARGUMENTS,
    "`{1}` measures time, not updates",
    "measure updates by `count`, `sum`, `mean`, `min`, `max`, `variance` or `distinct`",
)
not_added = Breach(
    WRONG_ARGUMENTS,
    "`{1}` measures {2}, and `{0}` is something else",
    "use `integral` or `mean` for signals, `sum` or `mean` for events",
)
"""Numbers that a function cannot measure. Arguments: the function, and what it measures."""

count_of_state = Breach(
    WRONG_TYPE,
    "in `time held` `{0}` holds at every nanosecond of a stretch and cannot be counted",
    "count where it starts, `rise({0})`, or measure it: `duration({0}, …)`",
)
amount_of_future = Breach(
    WRONG_TYPE,
    "`{1}` is of the past, and `{0}` refers to the future",
    "count what shows that it came, as in `count(e and once[0, 3 s] a, 1 min)`",
)
choice_alone = Breach(
    WRONG_TYPE,
    "`{}` is a choice, expected one number",
    "compare each side: `if φ then x <= 1 else x <= 2`",
)
many_outcomes = Breach(
    WRONG_TYPE, "`{0}` chooses between more than {1} numbers", "split it into several requirements"
)
not_constant = Breach(
    WRONG_TYPE, "`{}` changes during a run, expected a constant", "use a number or a `const`"
)
argument_count = Breach(
    WRONG_ARGUMENTS, "`{1}` takes {2}, {3} given", "arguments are separated by commas"
)
"""A wrong number of arguments: the function, how many it takes in words, and how many are given."""

argument_kind = Breach(WRONG_ARGUMENTS, "`{1}` needs {2}, and `{0}` is not one")
"""An argument of the wrong kind: the function, and the needed kind with its article."""


def argument_unit(span: Span, name: str, unit: str, needed: str) -> Diagnostic:
    """An argument in the wrong unit; `needed` is empty if the function takes a plain number."""
    text = short(span.text)
    shown = f"comes in [{unit}]" if unit else "has no unit"
    fix = (
        f"divide it by 1 {unit}"
        if unit
        else "declare it in `[rad]` or `[deg]`: an angle is not a plain number"
    )
    return finding(
        UNIT_MISMATCH,
        f"`{name}` takes {'an angle' if needed else 'a plain number'}, `{text}` {shown}",
        span,
        fix=fix,
    )


power_of_unit = Breach(
    UNIT_MISMATCH,
    "`{0}` leaves the power of [{1}] open",
    "write a whole number up to 9, or divide the base by one of its units",
)
mismatch = Breach(UNIT_MISMATCH, "[{1}] {3} [{2}]", "both sides need units of the same kind")
"""Units of different dimensions. Arguments: both units, and a word such as `compared with`."""

missing_unit = Breach(MISSING_UNIT, "`{0}` needs a unit", "did you mean `{0} {1}`?")
superfluous_unit = Breach(
    UNIT_MISMATCH,
    "[{1}] meets `{2}`, which has no unit",
    "declare the signal as `real [{1}]`, or leave the unit out",
)
no_root = Breach(
    UNIT_MISMATCH,
    "[{1}] has no square root",
    "the root of a square has a unit: `sqrt(x * x + y * y)`",
)


def unknown_unit(span: Span, part: str, close: str) -> Diagnostic:
    """A unit that is not in the table, or one whose parts are not joined by `*` or `/`.

    `close` is a similar unit, or empty. If it equals `part`, only the operator is missing.
    """
    fix = f"did you mean `{close}`?" if close else "units are made of m, kg, s, A, K, rad, …"
    if close == part:
        joined = "parts of a unit are joined by `*` and `/`: `N*m`, `kg*m/s^2`"
        return finding(UNKNOWN_UNIT, f"no `*` or `/` before `{short(part)}`", span, fix=joined)
    return finding(UNKNOWN_UNIT, f"no unit named `{short(part)}`", span, fix=fix)


swallowed_name = Breach(
    UNKNOWN_UNIT,
    "`{0}` is read as the unit of `{1}`, and there is no such unit",
    "give the number its unit: `{1} s {0}`",
)
out_of_range = Breach(
    OUT_OF_RANGE,
    "`{}` is out of range",
    "numbers go up to about 1e308, and nothing is divided by 0",
)
label_use = Breach(
    LABELS, "`{}` is a label", "labels are compared with their signal by `==` and `!=` only"
)

NO_DURATION = Rule("RV030", "no-duration", Severity.ERROR)
PART_OF_TICK = Rule("RV031", "part-of-a-tick", Severity.ERROR)
EMPTY_INTERVAL = Rule("RV032", "empty-interval", Severity.ERROR)
LATE_WEAK_WINDOW = Rule("RV033", "window-after-now", Severity.ERROR)
STEP_IN_HELD_TIME = Rule("RV034", "step-in-held-time", Severity.ERROR)
NO_WINDOW = Rule("RV035", "operator-without-window", Severity.ERROR)


def no_duration(span: Span, *, plain: bool = False) -> Diagnostic:
    """Something other than a constant with a unit of time; `plain`: it is a number without unit."""
    text = short(span.text)
    fix = (
        f"did you mean `{text.strip('() ')} s`?"
        if plain
        else "a duration is written as `3 s` or `200 ms`"
    )
    return finding(NO_DURATION, f"`{text}` is not a duration", span, fix=fix)


moving = Breach(
    NO_DURATION,
    "`{}` comes from data and is not a constant duration",
    "it is counted from a trigger: `upon e then within (x) φ`, or `(within (x) φ) and ψ`; below "
    "another operator of time compare with `let t0 = now`: `φ until now >= t0 + x`",
)
part_of_tick = Breach(
    PART_OF_TICK,
    "`{}` is not a whole number of nanoseconds",
    "durations are exact: choose a multiple of 1 ns",
)
too_long = Breach(EMPTY_INTERVAL, "`{}` is longer than 146 years", "shorten it")
negative = Breach(
    EMPTY_INTERVAL,
    "`{}` is negative, and a duration is not",
    "write it without `-`; use `once` and `historically` for the past",
)
empty = Breach(
    EMPTY_INTERVAL,
    "no instant lies in `{}`",
    "an open bound leaves its own instant out: write `[` and `]`",
)


def reversed_bounds(span: Span, low: Span, high: Span) -> Diagnostic:
    """An interval whose lower bound is above its upper bound."""
    swapped = f"{span.text[0]}{short(high.text)}, {short(low.text)}{span.text[-1]}"
    return finding(
        EMPTY_INTERVAL,
        f"`{short(span.text)}` ends before it starts",
        span,
        fix=f"did you mean `{swapped}`?",
    )


not_positive = Breach(EMPTY_INTERVAL, "{1} must be longer than 0", "give it some time: `1 ms`")
"""A duration of 0 where it makes no sense. Argument: the name of the duration."""

late_weak_window = Breach(
    LATE_WEAK_WINDOW,
    "`{1}` takes no window that starts after 0",
    "let it start at 0, or write it with `U` or `R`",
)
step_in_held_time = Breach(
    STEP_IN_HELD_TIME,
    "`{1}` has no meaning in `time held`: it would refer to the next nanosecond",
    "give a duration (`within`, `once[0, D]`) or declare `time sampled`",
)
step_back_in_held_time = Breach(
    STEP_IN_HELD_TIME,
    "`{1}` has no meaning in `time held`: it would refer to the nanosecond before",
    "for the value before the last update write `prev(x)`; else give a duration (`once[0, D]`), or "
    "declare `time sampled`",
)
ago_of_samples = Breach(
    STEP_IN_HELD_TIME,
    "`{}` asks for an instant at which there may be no sample",
    "use `prev(x)`, `once[D, D] φ`, or `time held`",
)
no_window = Breach(
    NO_WINDOW,
    "`{1}` takes no interval",
    "use `eventually`, `always`, `once` or `historically` with it",
)
