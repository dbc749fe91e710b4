"""Rules on CTL properties."""

from __future__ import annotations

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Rule, finding
from rvmon.spec.rules.syntax import short

PATH_OUTSIDE = Rule(
    "RV050",
    "path-quantifier",
    Severity.ERROR,
    "A path quantifier (`A[]`, `E<>`, `AG`, …) stands outside a `property`.",
    "A monitor sees one run; what holds on all or some runs is for a model checker, or is "
    "turned into a monitor on purpose.",
    """spec demo
signal a : bool

requirement R1
  AG a
""",
    """spec demo
signal a : bool

requirement R1
  always a
  property AG a
""",
)

RULES = (PATH_OUTSIDE,)


def path_outside(span: Span) -> Diagnostic:
    """A path quantifier in a formula that is monitored."""
    return finding(
        PATH_OUTSIDE,
        f"`{short(span.text)}` speaks of several runs and belongs into a `property`",
        span,
        mend="for one run write `always` or `eventually`",
    )
