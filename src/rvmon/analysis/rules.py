"""The findings of an analysis: their codes and pages."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.diagnostics.diagnostic import Severity
from rvmon.spec.rules.rule import Rule

NEVER_TRIGGERS = Rule(
    "RV070",
    "never-triggers",
    Severity.WARNING,
    "Nothing that can arrive triggers the requirement.",
    "It will be NT on every run, and look as if the situation had only not come up yet.",
    """spec demo
signal speed : real [m/s]
event stopped

requirement R1
  upon speed > 3 m/s and speed < 2 m/s
  then within 1 s stopped
""",
    """spec demo
signal speed : real [m/s]
event stopped

requirement R1
  upon speed > 3 m/s
  then within 1 s stopped
""",
)

NEVER_FAILS = Rule(
    "RV071",
    "never-fails",
    Severity.WARNING,
    "No run can fail the requirement.",
    "A requirement that cannot fail checks nothing. Most often its deadline is missing: without "
    "one a response that does not come only stays open.",
    """spec demo
event asked, released

requirement R1
  upon asked
  then eventually released
""",
    """spec demo
event asked, released

requirement R1
  upon asked
  then within 3 s released
""",
)

NEVER_PASSES = Rule(
    "RV072",
    "never-passes",
    Severity.WARNING,
    "No attempt of the requirement can pass.",
    "Every run that triggers it fails or stays open, whatever the system does. The instant of the "
    "trigger belongs to the window of the consequent.",
    """spec demo
event knock

requirement R1
  upon knock
  then for 1 s not knock
""",
    """spec demo
event knock

requirement R1
  upon knock
  then always[1 ns, 1 s] not knock
""",
)

CONFLICT = Rule(
    "RV073",
    "conflict",
    Severity.WARNING,
    "Requirements that cannot all hold once they are triggered so; or one, triggered again.",
    "Each can be met by itself, but no run meets all of them. `rvmon check --analyse` draws the "
    "shortest run after which one of them must fail.",
    """spec demo
event asked, released

requirement R1
  upon asked
  then within 1 s released

requirement R2
  upon asked
  then for 2 s not released
""",
    """spec demo
event asked, released

requirement R1
  upon asked
  then within 3 s released

requirement R2
  upon asked
  then for 2 s not released
""",
)

IMPLIED = Rule(
    "RV074",
    "implied",
    Severity.WARNING,
    "A requirement that fails only where another one, or one of several others, fails.",
    "It adds nothing to the others; perhaps one of them was meant otherwise.",
    """spec demo
event asked, released

requirement R1
  upon asked
  then within 1 s released

requirement R2
  upon asked
  then within 3 s released
""",
    """spec demo
event asked, released

requirement R1
  upon asked
  then within 1 s released
""",
)

RULES = (NEVER_TRIGGERS, NEVER_FAILS, NEVER_PASSES, CONFLICT, IMPLIED)


def analysis_rules() -> Mapping[str, Rule]:
    """The rules by code."""
    return {rule.code: rule for rule in RULES}
