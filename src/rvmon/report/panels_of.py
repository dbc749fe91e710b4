"""Which panels the page of a run has."""

from __future__ import annotations

from rvmon.report.choose import shown_attempts
from rvmon.report.nearest import nearest_passing
from rvmon.report.panel import Panel
from rvmon.report.run_page import RunPage
from rvmon.report.tracks_of import tracks_of
from rvmon.report.view import view_of, whole_run
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict


def panels_of(content: RunPage) -> list[Panel]:
    """A panel for each attempt that is shown, and for each requirement that was not triggered."""
    report, spec = content.run.report, content.spec
    samples = content.run.samples
    first = samples[0].t if samples else report.origin
    panels = []
    for name, attempts in shown_attempts(report).items():
        tracks = tracks_of(spec, spec.requirements[name], samples, report.health)
        chosen: list[Attempt | None] = [*attempts] or [None]
        for attempt in chosen:
            view = whole_run(report, first) if attempt is None else view_of(attempt, report)
            ghost = None
            if attempt is not None and attempt.verdict is Verdict.FAIL:
                runs = (content.run, *content.others)
                ghost = nearest_passing(attempt, tracks, view, spec, runs)
            panels.append(Panel(panel_id(name, attempt), name, attempt, view, tracks, ghost))
    return panels


def panel_id(requirement: str, attempt: Attempt | None) -> str:
    """The address of an attempt on the page, or of a requirement without any."""
    return requirement if attempt is None else f"{requirement}-{attempt.number}"
