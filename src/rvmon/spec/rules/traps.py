"""Rules on requirements that can be judged, but hardly say what was meant."""

from __future__ import annotations

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Breach, Rule, finding, short

NO_VALUE = Rule("RV028", "no-value-to-capture", Severity.WARNING)

AT_TRIGGER = Rule("RV047", "false-at-trigger", Severity.WARNING)

AT_FIRST = Rule("RV048", "false-at-first", Severity.WARNING)

ONCE_CAPTURED = Rule("RV049", "captured-once", Severity.WARNING)

RULES = (NO_VALUE, AT_TRIGGER, AT_FIRST, ONCE_CAPTURED)


no_value = Breach(
    NO_VALUE,
    "`{0}` has no value unless `{1}` occurs at the trigger, which does not require it",
    "let `{1}` trigger it: `upon {1} and …`",
)


def false_at_trigger(span: Span, part: str, escape: str, fix: str) -> Diagnostic:
    """What is owed contradicts its trigger."""
    unless = f" unless `{short(escape)}` holds at that very instant" if escape else ""
    return finding(
        AT_TRIGGER,
        f"`{short(part)}` is false at the trigger itself, by its condition: it fails there"
        + (unless or " each time"),
        span,
        fix=fix,
    )


def false_at_first(span: Span, when: str, fix: str) -> Diagnostic:
    """What is owed from the start on cannot hold then; `when` says at which instant."""
    text = short(span.text)
    return finding(
        AT_FIRST, f"`{text}` is false {when}, whatever comes: it fails there", span, fix=fix
    )


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
