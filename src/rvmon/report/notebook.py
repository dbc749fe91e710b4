"""HTML fragments of specifications, reports and attempts, for notebooks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from itertools import islice
from xml.etree.ElementTree import Element

from markupsafe import Markup

from rvmon.language.checked.specification import CheckedSpec
from rvmon.report.attempt_panels import shown_attempts
from rvmon.report.html import asset, render
from rvmon.report.panel_html import spec_lines
from rvmon.report.time_axis import View, view_of, whole_run
from rvmon.report.timeline import axis_row, place_of, timeline
from rvmon.report.wording import MARKS, full_reason, verdict_colours, without_attempts
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report, report_of

DRAWN = 200  # the most attempts drawn per requirement and verdict; the rest is counted

_DARK = re.compile(
    r"@media (?:screen and )?\(prefers-color-scheme: ?dark\) ?\{\s*:root ?\{(.*?)\}\s*\}", re.DOTALL
)
_THEMES = (
    r"@media(prefers-color-scheme:dark){:root:not([data-jp-theme-light=true] *){\1}}"
    r":is([data-jp-theme-light=false],.vscode-dark) :root{\1}"
)
"""Replacement for `_DARK`: the theme of the notebook takes precedence over the system's."""

_OWN = (
    ":root{padding:.75rem 1rem;border-radius:.5rem}"
    ":root h1{font-size:1.05rem;margin:.25rem 0 .4rem}"
)
"""Rules as specific as the notebook's own for headings, so that ours, which come later, win."""


def attempt_html(attempt: Attempt) -> str:
    """An attempt with its reason and a timeline of window, trigger, deadline and decision.

    Signals are not drawn, because an attempt contains only their values at two instants.
    """
    report = report_of([attempt.requirement], [attempt], origin=attempt.origin, end=attempt.decided)
    return _piece(attempt=attempt, facts_of=partial(_facts, report))


def report_html(report: Report) -> str:
    """The attempts of each requirement over the run, then details of those not passed."""
    view = whole_run(report, report.origin)
    return _piece(
        report=report,
        rows=[(name, list(_bars(report, name, view))) for name in report.verdicts],
        axis=axis_row(view, report.origin),
        requirements=list(_requirements(report)),
        facts_of=partial(_facts, report),
    )


def spec_html(spec: CheckedSpec) -> str:
    """The requirements with text, severity, tags, and their lines of the file."""
    return _piece(spec=spec, spec_lines=spec_lines)


def _requirements(report: Report) -> Iterator[tuple[str, str, list[Attempt], int]]:
    """For each requirement: why it has no attempt, its attempts not passed, the number of more."""
    for name, attempts in shown_attempts(report).items():
        silence = ""
        if report.is_silent(name):
            silence = without_attempts(report.verdicts[name], report.misses.get(name, ""))
        wrong = [attempt for attempt in attempts if attempt.verdict is not Verdict.PASS]
        counts = report.counts[name]
        yield name, silence, wrong, sum(counts.values()) - counts[Verdict.PASS] - len(wrong)


def _facts(report: Report, attempt: Attempt) -> tuple[str, Element, str]:
    """The reason of an attempt, its timeline, and values at its decision."""
    why = full_reason(attempt, report) or MARKS[attempt.verdict].word
    end = attempt.triggered if report.end is None else report.end
    drawing = timeline(attempt, (), view_of(attempt, report), origin=report.origin, end=end)
    values = [f"`{text}` {str(value).lower()}" for text, value in attempt.at_decision.items()]
    return why, drawing, ", ".join(values)


def _bars(report: Report, name: str, view: View) -> Iterator[tuple[Attempt, str]]:
    """A bar from trigger to decision for each attempt."""
    for verdict in (Verdict.PASS, Verdict.INCONCLUSIVE, Verdict.FAIL):
        for attempt in islice(report.of(name, verdict), DRAWN):
            left = view.fraction(attempt.triggered)
            right = view.fraction(view.end if attempt.decided is None else attempt.decided)
            yield attempt, place_of(left, max(right - left, 0.002))


def _piece(**values: object) -> str:
    """An HTML fragment whose style applies to it alone."""
    style = "".join([verdict_colours(), asset("base.css"), asset("run.css"), _OWN])
    # A fragment has no root or body, so their rules go to its outermost element.
    style = re.sub(r"(?<![.\w-])body\b", ":root", _DARK.sub(_THEMES, style))
    scoped = Markup(f"@scope (.rvmon){{{style.replace(':root', ':scope')}}}")  # noqa: S704 - our own
    none = {"attempt": None, "report": None, "spec": None}
    return render("notebook.html", **{**none, **values, "style": scoped})
