"""Rules on durations, intervals and operators of time."""

from __future__ import annotations

from rvmon.diagnostics import Diagnostic, Severity, Span
from rvmon.language.rules import Breach, Rule, finding, short

NO_DURATION = Rule("RV030", "no-duration", Severity.ERROR)
PART_OF_TICK = Rule("RV031", "part-of-a-tick", Severity.ERROR)
EMPTY_INTERVAL = Rule("RV032", "empty-interval", Severity.ERROR)
LATE_WEAK_WINDOW = Rule("RV033", "window-after-now", Severity.ERROR)
STEP_IN_HELD_TIME = Rule("RV034", "step-in-held-time", Severity.ERROR)
NO_WINDOW = Rule("RV035", "operator-without-window", Severity.ERROR)


def no_duration(span: Span, *, plain: bool = False) -> Diagnostic:
    """Something that is no constant with a unit of time; `plain`: a number without unit."""
    text = short(span.text)
    fix = (
        f"did you mean `{text.strip('() ')} s`?"
        if plain
        else "a duration is written as `3 s` or `200 ms`"
    )
    return finding(NO_DURATION, f"`{text}` is no duration", span, fix=fix)


moving = Breach(
    NO_DURATION,
    "`{}` comes from data, and is no constant duration",
    "it is counted from a trigger: `upon e then within (x) φ`, or `(within (x) φ) and ψ`; below "
    "another operator of time compare with `let t0 = now`: `φ until now >= t0 + x`",
)
part_of_tick = Breach(
    PART_OF_TICK,
    "`{}` is no whole number of nanoseconds",
    "durations are exact: choose a multiple of 1 ns",
)
too_long = Breach(EMPTY_INTERVAL, "`{}` is longer than 146 years", "shorten it")
negative = Breach(
    EMPTY_INTERVAL,
    "`{}` is negative, and a duration is not",
    "write it without `-`; what has been is asked for by `once` and `historically`",
)
empty = Breach(
    EMPTY_INTERVAL,
    "no instant lies in `{}`",
    "an open bound leaves its own instant out: write `[` and `]`",
)


def reversed_bounds(span: Span, low: Span, high: Span) -> Diagnostic:
    """An interval whose first bound is after its second."""
    swapped = f"{span.text[0]}{short(high.text)}, {short(low.text)}{span.text[-1]}"
    return finding(
        EMPTY_INTERVAL,
        f"`{short(span.text)}` ends before it starts",
        span,
        fix=f"did you mean `{swapped}`?",
    )


not_positive = Breach(EMPTY_INTERVAL, "{1} must be longer than 0", "give it some time: `1 ms`")
"""A duration of 0 where it makes no sense: its use."""


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
    "of a value before its last change speaks `prev(x)`; else give a duration (`once[0, D]`), or "
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
