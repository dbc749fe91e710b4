"""One sentence that says what happened."""

from __future__ import annotations

from rvmon.report.afterword import with_afterword, without_attempts
from rvmon.report.panel import Panel
from rvmon.report.style import MARKS
from rvmon.report.view import moment, with_moments


def headline(run: str, panel: Panel, origin: int) -> str:
    """What became of a requirement in a run, or of one attempt.

    Args:
        run: its name.
        panel: about the attempt.
        origin: the instant from which people count seconds, ticks.

    >>> from rvmon.report.view import View
    >>> from rvmon.verdict.attempt import Attempt
    >>> from rvmon.verdict.verdict import Verdict
    >>> failed = Attempt("R2", 1, 0, 14_250_000_000, Verdict.FAIL, reason="`released` too soon")
    >>> view = View(0, 20_000_000_000)
    >>> panel = Panel("R2-1", "R2", failed, failed.verdict, view, (), None)
    >>> headline("test 17", panel, 0)
    'R2 failed, test 17, 14.25 s: `released` too soon'
    """
    attempt = panel.attempt
    if attempt is None:
        why = without_attempts(panel.verdict, with_moments(panel.miss, panel.view))
        return f"{panel.requirement} {MARKS[panel.verdict].word}, {run}: {why}"
    when = "" if attempt.decided is None else f", {moment(attempt.decided, origin, panel.view)}"
    why = with_afterword(attempt, panel.late)
    reason = f": {with_moments(why, panel.view)}" if why else ""
    return f"{panel.requirement} {MARKS[attempt.verdict].word}, {run}{when}{reason}"
