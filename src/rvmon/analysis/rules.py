"""The findings of an analysis: their codes."""

from __future__ import annotations

from rvmon.diagnostics.diagnostic import Severity
from rvmon.spec.rules.rule import Rule

NEVER_TRIGGERS = Rule("RV070", "never-triggers", Severity.WARNING)

NEVER_FAILS = Rule("RV071", "never-fails", Severity.WARNING)

NEVER_PASSES = Rule("RV072", "never-passes", Severity.WARNING)

CONFLICT = Rule("RV073", "conflict", Severity.WARNING)

IMPLIED = Rule("RV074", "implied", Severity.WARNING)

RULES = (NEVER_TRIGGERS, NEVER_FAILS, NEVER_PASSES, CONFLICT, IMPLIED)
