"""What is reported of a run of which a call was torn: it began, and did not come to its end.

Attempts may be missing then, or have missed what that call brought. What has failed, has; that
nothing else did is not known.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rvmon.trace.health import Health, HealthKind
from rvmon.trace.time import TIME_LIMIT
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold

BEFORE_ALL = 1 - TIME_LIMIT
"""The instant of a call that was torn before any sample was taken."""


def not_passed(verdicts: Mapping[str, Verdict]) -> Mapping[str, Verdict]:
    """Verdicts of which those that are not `F` are `I`."""
    return {name: fold([verdict], complete=False) for name, verdict in verdicts.items()}


def capped(report: Report, torn: int) -> Report:
    """A report without verdicts that are not known, and why.

    Args:
        report: of the run.
        torn: how far it had come when a call was interrupted, ticks.
    """
    first = None if torn == BEFORE_ALL else torn
    remark = "what followed was not evaluated in full"
    why = Health(HealthKind.INTERRUPTED, "monitor", 1, first, tuple(report.verdicts), remark)
    return replace(report, verdicts=not_passed(report.verdicts), health=(why, *report.health))
