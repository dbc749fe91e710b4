"""One sentence that says what happened."""

from __future__ import annotations

from rvmon.report.style import MARKS
from rvmon.report.view import moment
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict


def headline(run: str, requirement: str, attempt: Attempt | None, report: Report) -> str:
    """What became of a requirement in a run.

    Args:
        run: its name.
        requirement: its id.
        attempt: the one in question; `None` if there was none.
        report: of the run.

    >>> from rvmon.verdict.assemble import report_of
    >>> failed = Attempt("R2", 1, 0, 14_250_000_000, Verdict.FAIL, reason="`released` too soon")
    >>> headline("test 17", "R2", failed, report_of(["R2"], [failed]))
    'R2 failed, test 17, 14.25 s: `released` too soon'
    """
    if attempt is None:
        return f"{requirement} {MARKS[Verdict.NOT_TRIGGERED].word}, {run}"
    when = "" if attempt.decided is None else f", {moment(attempt.decided, report.origin)}"
    reason = f": {attempt.reason}" if attempt.reason else ""
    return f"{requirement} {MARKS[attempt.verdict].word}, {run}{when}{reason}"
