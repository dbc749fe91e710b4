"""Rules on requirements that can be judged, but hardly say what was meant."""

from __future__ import annotations

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Rule, finding, short

NO_VALUE = Rule(
    "RV028",
    "no-value-to-capture",
    Severity.WARNING,
    "`let` captures a field of an event that need not occur at the trigger.",
    "An event has fields only at the instant at which it occurs. Where the trigger is another, the "
    "captured value is unknown, and whatever is compared with it stays open.",
    """spec demo
event asked
event picked(id: int)
event placed(id: int)

requirement R1
  upon asked
  then within 3 s placed.id == part
  let part = picked.id
""",
    """spec demo
event asked
event picked(id: int)
event placed(id: int)

requirement R1
  upon picked and once[0, 5 s] asked
  then within 3 s placed.id == part
  let part = picked.id
""",
)

AT_TRIGGER = Rule(
    "RV047",
    "false-at-trigger",
    Severity.WARNING,
    "The consequent is false at the trigger itself, by the trigger's own condition.",
    "The instant of the trigger belongs to the consequent: `upon a then not a unless b` fails "
    "where `a` starts it, unless `b` comes at that very instant. What has to hold afterwards "
    "begins a tick later.",
    """spec demo
event asked, answered

requirement R1 "No second question before the answer"
  upon asked
  then not asked unless answered
""",
    """spec demo
event asked, answered

requirement R1 "No second question before the answer"
  upon asked
  then answered R[1 ns, inf) (not asked)
""",
)

AT_FIRST = Rule(
    "RV048",
    "false-at-first",
    Severity.WARNING,
    "A consequent from the start on is false at the first instant, or the second, whatever comes.",
    "Before the first instant there is nothing: `previous p`, `held(p, D)`, `fall(p)` and "
    "`once[a, b] p` with a > 0 are false there, and `rise(p)` is never true twice in a row. As an "
    "invariant each fails on every run.",
    """spec demo
signal powered : bool

requirement R1
  always held(powered, 3 s)
""",
    """spec demo
signal powered : bool

requirement R1
  always[3 s, inf) held(powered, 3 s)
""",
)

ONCE_CAPTURED = Rule(
    "RV049",
    "captured-once",
    Severity.WARNING,
    "`let` stands under `whenever`, which captures once per stretch, not at each instant.",
    "The instants at which the condition of a `whenever` holds on end are one attempt. The value "
    "is that of its first instant, also for the consequent at a later one.",
    """spec demo
signal moving : bool
signal speed : real [m/s]

requirement R1
  whenever moving
  then for 1 s speed <= v + 0.1 m/s
  let v = speed
""",
    """spec demo
signal moving : bool
signal speed : real [m/s]

requirement R1
  upon moving
  then for 1 s speed <= v + 0.1 m/s
  let v = speed
""",
)

RULES = (NO_VALUE, AT_TRIGGER, AT_FIRST, ONCE_CAPTURED)


def no_value(span: Span, event: str) -> Diagnostic:
    """A capture of a field of an event that the trigger does not speak of."""
    return finding(
        NO_VALUE,
        f"`{short(span.text)}` has no value unless `{event}` occurs at the trigger, which does "
        "not require it",
        span,
        fix=f"let `{event}` trigger it: `upon {event} and …`",
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
