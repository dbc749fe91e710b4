"""Rules on types and units."""

from __future__ import annotations

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Breach, Rule, finding, short

WRONG_TYPE = Rule("RV020", "wrong-type", Severity.ERROR)

WRONG_ARGUMENTS = Rule("RV021", "wrong-arguments", Severity.ERROR)

UNIT_MISMATCH = Rule("RV022", "unit-mismatch", Severity.ERROR)

MISSING_UNIT = Rule("RV023", "missing-unit", Severity.ERROR)

UNKNOWN_UNIT = Rule("RV024", "unknown-unit", Severity.ERROR)

OUT_OF_RANGE = Rule("RV025", "number-out-of-range", Severity.ERROR)

LABELS = Rule("RV026", "label-use", Severity.ERROR)

IGNORED_NAN = Rule("RV027", "nan-of-no-real", Severity.ERROR)

RULES = (
    WRONG_TYPE,
    WRONG_ARGUMENTS,
    UNIT_MISMATCH,
    MISSING_UNIT,
    UNKNOWN_UNIT,
    OUT_OF_RANGE,
    LABELS,
    IGNORED_NAN,
)


def ignored_nan(span: Span, kind: str) -> Diagnostic:
    """`ignore NaN` where there is none; `kind` is that of the signal."""
    shown = "with labels" if kind == "label" else f"of type `{kind}`"
    return finding(
        IGNORED_NAN,
        f"a signal {shown} is never NaN",
        span,
        fix="remove `ignore NaN`, or declare the signal `real`",
    )


def needs_formula(span: Span, kind: str) -> Diagnostic:
    """A number or label where something true or false is needed; `kind` says what it is."""
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


def age_alone(span: Span) -> Diagnostic:
    """`age(x)` other than compared with a duration."""
    return finding(
        WRONG_TYPE,
        f"`{short(span.text)}` can only be compared with a constant duration, by < <= > >=",
        span,
        fix=f"write `{short(span.text)} > 200 ms`",
    )


now_alone = Breach(
    WRONG_TYPE,
    "`{}` is not what `now` is for: it is compared with a duration, by < <= > >=",
    "with `let t0 = now` write `now - t0 <= x` or `now <= t0 + x`; the time since an event is "
    "its age: `age(e) > 3 s`",
)
amount_alone = Breach(
    WRONG_TYPE,
    "`{}` can only be compared, with what does not move between samples",
    "write `count(e, 5 s) >= 3`, `duration(φ, 60 s) <= 4 s`, `mean(x, 1 h) >= x / 1.2`",
)
limit_of_event = Breach(
    WRONG_TYPE,
    "`{}` is there only while its event occurs, and what adds up goes on",
    "capture it: `let limit = e.x`",
)
sum_of_instances = Breach(
    WRONG_TYPE,
    "`{}` has a field of an event, of which `for each` may see several at one instant",
    "count them, `count(e.k == k, D)`, or publish the sum of each as a signal",
)
_ADDED = {
    "sum": "a field of an event, or one signal, which is added at its updates",
    "integral": "signals: what they hold is multiplied by time",
    "mean": "signals, or fields of an event, but not of both",
}


def not_added(span: Span, name: str) -> Diagnostic:
    """Numbers that are not added up by that function."""
    fix = "what is held goes into `integral` or `mean`, what occurs into `sum` or `mean`"
    message = f"`{name}` is of {_ADDED[name]}, and `{short(span.text)}` is not"
    return finding(WRONG_ARGUMENTS, message, span, fix=fix)


extreme_alone = Breach(
    WRONG_TYPE,
    "`{}` can only be compared with a constant, or with a captured value",
    "write `max(x, 5 s) <= 1`, or capture the other side: `let v = y`",
)


def count_of_state(span: Span) -> Diagnostic:
    """A count of what holds for a while, at each tick."""
    text = short(span.text)
    return finding(
        WRONG_TYPE,
        f"in `time held` `{text}` holds at every nanosecond of a stretch, and is not counted",
        span,
        fix=f"count where it begins, `rise({text})`, or measure it: `duration({text}, …)`",
    )


def amount_of_future(span: Span, name: str) -> Diagnostic:
    """An amount of what is not known at once."""
    return finding(
        WRONG_TYPE,
        f"`{name}` is of the past, and `{short(span.text)}` speaks of the future",
        span,
        fix="count what shows that it came, as in `count(e and once[0, 3 s] a, 1 min)`",
    )


choice_alone = Breach(
    WRONG_TYPE,
    "`{}` is a choice, expected one number",
    "compare each side: `if φ then x <= 1 else x <= 2`",
)


def many_outcomes(span: Span, most: int) -> Diagnostic:
    """Choices within choices."""
    return finding(
        WRONG_TYPE,
        f"`{short(span.text)}` chooses between more than {most} numbers",
        span,
        fix="split it into several requirements",
    )


not_constant = Breach(
    WRONG_TYPE, "`{}` changes during a run, expected a constant", "use a number or a `const`"
)


def argument_count(span: Span, name: str, takes: str, given: int) -> Diagnostic:
    """Too many or too few arguments; `takes` says how many, in words."""
    return finding(
        WRONG_ARGUMENTS,
        f"`{name}` takes {takes}, {given} given",
        span,
        fix="arguments are separated by commas",
    )


def argument_kind(span: Span, name: str, needed: str) -> Diagnostic:
    """An argument of the wrong kind; `needed` says which kind is needed, with its article."""
    return finding(WRONG_ARGUMENTS, f"`{name}` needs {needed}, `{short(span.text)}` is none", span)


def argument_unit(span: Span, name: str, unit: str, needed: str) -> Diagnostic:
    """An argument of another unit than a function takes; `needed` is empty for a plain number."""
    text = short(span.text)
    shown = f"comes in [{unit}]" if unit else "has no unit"
    fix = (
        f"divide it by 1 {unit}"
        if unit
        else "declare it in `[rad]` or `[deg]`: an angle is no plain number"
    )
    return finding(
        UNIT_MISMATCH,
        f"`{name}` takes {'an angle' if needed else 'a plain number'}, `{text}` {shown}",
        span,
        fix=fix,
    )


def power_of_unit(span: Span, unit: str) -> Diagnostic:
    """A power of something with a unit that is not known beforehand."""
    return finding(
        UNIT_MISMATCH,
        f"`{short(span.text)}` leaves open which power of [{unit}] comes out",
        span,
        fix="write a whole number up to 9, or divide the base by one of its units",
    )


def mismatch(span: Span, left: str, right: str, doing: str) -> Diagnostic:
    """Units of different kinds; `doing` is `compared with` and the like."""
    return finding(
        UNIT_MISMATCH,
        f"[{left}] {doing} [{right}]",
        span,
        fix="both sides need units of the same kind",
    )


def missing_unit(span: Span, unit: str) -> Diagnostic:
    """A plain number where a unit is needed."""
    text = short(span.text)
    return finding(
        MISSING_UNIT, f"`{text}` needs a unit", span, fix=f"did you mean `{text} {unit}`?"
    )


def superfluous_unit(span: Span, unit: str, other: Span) -> Diagnostic:
    """A number with a unit where the other side has none."""
    return finding(
        UNIT_MISMATCH,
        f"[{unit}] meets `{short(other.text)}`, which has no unit",
        span,
        fix=f"declare the signal as `real [{unit}]`, or leave the unit out",
    )


def no_root(span: Span, unit: str) -> Diagnostic:
    """A root of a unit that has none."""
    return finding(
        UNIT_MISMATCH,
        f"[{unit}] has no square root",
        span,
        fix="the root of a square has a unit: `sqrt(x * x + y * y)`",
    )


def unknown_unit(span: Span, part: str, close: str) -> Diagnostic:
    """A unit that is not in the table; `close` is one that is alike, or empty."""
    fix = f"did you mean `{close}`?" if close else "units are made of m, kg, s, A, K, rad, …"
    return finding(UNKNOWN_UNIT, f"no unit named `{short(part)}`", span, fix=fix)


def swallowed_name(span: Span, number: str) -> Diagnostic:
    """A name that is read as the unit of the number before it."""
    name = short(span.text)
    return finding(
        UNKNOWN_UNIT,
        f"`{name}` is read as the unit of `{number}`, and there is no such unit",
        span,
        fix=f"give the number its unit: `{number} s {name}`",
    )


out_of_range = Breach(
    OUT_OF_RANGE,
    "`{}` is out of range",
    "numbers go up to about 1e308, and nothing is divided by 0",
)
label_use = Breach(
    LABELS, "`{}` is a label", "labels are compared with their signal by `==` and `!=` only"
)
