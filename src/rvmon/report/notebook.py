"""Specifications, reports and attempts as notebooks show them: a piece of HTML each."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice

from rvmon.report.afterword import full_reason, without_attempts
from rvmon.report.markup import Child, asset, e, to_html, with_code
from rvmon.report.panel_html import spec_lines
from rvmon.report.panels_of import shown_attempts
from rvmon.report.style import MARKS, verdict_colours
from rvmon.report.timeline import axis_row, place_of, timeline
from rvmon.report.view import View, view_of, whole_run
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report, report_of
from rvmon.verdict.verdict import Verdict

DRAWN = 200
"""Attempts of each verdict that are drawn per requirement, the first ones; the rest is counted."""

_DARK = re.compile(
    r"@media (?:screen and )?\(prefers-color-scheme: ?dark\) ?\{\s*:root ?\{(.*?)\}\s*\}", re.DOTALL
)
_THEMES = (
    r"@media(prefers-color-scheme:dark){:root:not([data-jp-theme-light=true] *){\1}}"
    r":is([data-jp-theme-light=false],.vscode-dark) :root{\1}"
)
"""A notebook's own theme comes before that of the system."""

_OWN = (
    ":root{padding:.75rem 1rem;border-radius:.5rem}"
    ":root h1{font-size:1.05rem;margin:.25rem 0 .4rem}"
)
"""As specific as a notebook's own rules for headings, which come before."""


def attempt_html(attempt: Attempt) -> str:
    """What became of an attempt, and when: its window, trigger, deadline and decision.

    Args:
        attempt: any; of its signals nothing is drawn, as it keeps no more than their values.
    """
    report = report_of([attempt.requirement], [attempt], end=attempt.decided)
    return _piece(*_attempt(attempt, report))


def report_html(report: Report) -> str:
    """The attempts of each requirement over the run, then those that did not pass, one by one."""
    view = whole_run(report, report.origin)
    parts: list[Child] = [_title(f"{report.trace or 'run'}: ", ", ".join(_counted(report)))]
    rows = [_row(report, name, view) for name in report.verdicts]
    parts.append(e("div", {"class": "timeline"}, *rows, axis_row(view, report.origin)))
    for name, attempts in shown_attempts(report).items():
        if report.is_silent(name):
            why = without_attempts(report.verdicts[name], report.misses.get(name, ""))
            parts.append(e("p", None, f"{name}: ", *with_code(why)))
        wrong = [one for one in attempts if one.verdict is not Verdict.PASS]
        parts += [
            e(
                "details",
                {"open": one is wrong[0]},
                e("summary", None, one.name),
                *_attempt(one, report),
            )
            for one in wrong
        ]
        counts = report.counts[name]
        rest = sum(counts.values()) - counts[Verdict.PASS] - len(wrong)
        if rest:
            parts.append(e("p", {"class": "soft"}, f"… and {rest:,} more of {name}"))
    return _piece(*parts)


def spec_html(spec: CheckedSpec) -> str:
    """The requirements: text, severity, tags, and the lines of the file."""
    parts: list[Child] = [_title(spec.name)]
    for name, one in spec.requirements.items():
        labels = " · ".join(text for text in (one.severity, *one.tags) if text)
        parts.append(e("p", None, e("b", None, name), f" {one.text} ", e("small", None, labels)))
        parts.append(spec_lines(one, None))
    return _piece(*parts)


def _title(*texts: str) -> Child:
    return e("h1", None, e("span", None, *texts))


def _counted(report: Report) -> Iterator[str]:
    for name, verdict in report.verdicts.items():
        yield f"{name} {MARKS[verdict].word}"


def _attempt(attempt: Attempt, report: Report) -> Iterator[Child]:
    mark = MARKS[attempt.verdict]
    badge = {"class": "badge", "data-verdict": attempt.verdict.value}
    why = full_reason(attempt, report) or mark.word
    sign = e("span", badge, f"{attempt.verdict.value} {mark.sign}")
    yield e("h1", None, sign, e("span", None, f"{attempt.name}: ", *with_code(why)))
    end = attempt.triggered if report.end is None else report.end
    yield timeline(attempt, (), view_of(attempt, report), origin=report.origin, end=end)
    values = [f"`{text}` {str(value).lower()}" for text, value in attempt.at_decision.items()]
    if values:
        when = e("span", None, "at the decision: ", *with_code(", ".join(values)))
        yield e("p", {"class": "legend"}, when)


def _row(report: Report, name: str, view: View) -> Child:
    """A bar from trigger to decision for each attempt, in the colour of its verdict."""
    plot = e("div", {"class": "plot switch"})
    for verdict in (Verdict.PASS, Verdict.INCONCLUSIVE, Verdict.FAIL):
        for one in islice(report.of(name, verdict), DRAWN):
            left = view.fraction(one.triggered)
            right = view.fraction(view.end if one.decided is None else one.decided)
            style = f"{place_of(left, max(right - left, 0.002))};background:var(--verdict)"
            marks = {"class": "on", "data-verdict": verdict.value, "title": str(one)}
            plot.append(e("div", {**marks, "style": style}))
    verdict = report.verdicts[name]
    label = e("b", {"data-verdict": verdict.value}, f"{name} {verdict.value} {MARKS[verdict].sign}")
    return e("div", {"class": "row"}, e("div", {"class": "name"}, label), plot)


def _piece(*children: Child) -> str:
    """A piece of HTML whose style reaches nothing else."""
    style = "".join([verdict_colours(), asset("base.css"), asset("run.css"), _OWN])
    style = re.sub(r"(?<![.\w-])body\b", ":root", _DARK.sub(_THEMES, style))
    scoped = f"@scope (.rvmon){{{style.replace(':root', ':scope')}}}"
    return to_html(e("div", {"class": "rvmon"}, e("style", None, scoped), *children))
