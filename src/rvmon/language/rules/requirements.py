"""Rules on requirements: their trigger, consequent and clauses, and what they hardly mean."""

from __future__ import annotations

from collections.abc import Sequence

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
"""A part required from the start on that cannot hold then: at which instant, and the fix."""


def captured_once(span: Span, trigger: str) -> Diagnostic:
    """A capture under `whenever`; `trigger` is its condition, empty if that always holds."""
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
    "move it behind `then`, or use `once`, `historically`, `since`",
)
end_not_alone = Breach(
    END_NOT_ALONE,
    "`end` stands only alone, as `upon end`",
    "write `upon end` and put the rest behind `then`",
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
"""A disjunction of an event and a state: the places of both, and the text of the state."""

double_clause = Breach(
    DOUBLE_CLAUSE, "a requirement has one `{1}` clause", "join them, or remove one", "first here"
)


def unknown_policy(span: Span, policies: Sequence[str]) -> Diagnostic:
    """A policy that does not exist."""
    fix = did_you_mean(span.text, policies, f"there are {', '.join(policies)}")
    return finding(UNKNOWN_POLICY, f"no policy named `{short(span.text)}`", span, fix=fix)


bad_run_share = Breach(
    RUN_SHARE,
    "`{}` is no percentage between 0 and 100",
    "write `in at least 95 % of runs`; for all runs the clause is left out",
)


never_read = Breach(
    NEVER_READ,
    "{1} `{2}` is read by no requirement",
    "remove it, or look for the requirement that should read it",
)
"""A declared name that nothing reads: `signal` or `event`, and the name."""
