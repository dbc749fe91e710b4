"""One attempt on the page of a run: headline, lines of the specification, timelines."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

from rvmon.analysis.subformulas import PartTruth
from rvmon.language.checked.specification import Requirement
from rvmon.report.attempt_panels import Panel
from rvmon.report.changes import Course
from rvmon.report.html import Child, e
from rvmon.report.time_axis import moment, with_moments
from rvmon.report.timeline import axis_row, guides_of, timeline, truth_row
from rvmon.report.tracks import Track, TrackKind, blamed_names
from rvmon.report.wording import MARKS, reason_text, without_attempts
from rvmon.trace.sample import Scalar
from rvmon.verdicts.attempt import Blame
from rvmon.verdicts.report import Report

DEEPEST = 8  # deeper subformulas are not indented further


def parts_timeline(panel: Panel, report: Report) -> ET.Element:
    """The timeline of subformulas: a row for each of trigger and consequent."""
    assert panel.attempt is not None, "as only these have part_truths"
    end = end_of(report)
    rows: list[Child] = []
    for part, part_truths in groupby(panel.part_truths, key=lambda part_truth: part_truth.part):
        rows.append(e("div", {"class": "part"}, part))
        rows += [_row(part_truth, panel, end) for part_truth in part_truths]
    rows.append(axis_row(panel.view, report.origin))
    guides = guides_of(panel.attempt, panel.view, end, panel.late)
    overlay = e("div", {"class": "overlay"}, *guides, e("div", {"class": "cursor"}))
    return e("div", {"class": "timeline"}, *rows, overlay)


def panel_timeline(panel: Panel, requirement: Requirement, report: Report) -> ET.Element:
    """The attempt's window, and a track for each signal that the requirement reads."""
    blame = None if panel.attempt is None else panel.attempt.blame
    return timeline(
        panel.attempt,
        panel.tracks,
        panel.view,
        origin=report.origin,
        end=end_of(report),
        blamed=frozenset() if blame is None else blamed_names(requirement, blame),
        late=panel.late,
        reference=panel.reference,
    )


def end_of(report: Report) -> int:
    """The last instant of a run, ticks."""
    return report.origin if report.end is None else report.end


def _row(part_truth: PartTruth, panel: Panel, end: int) -> ET.Element:
    indent = f"padding-left:{0.7 * min(part_truth.depth, DEEPEST):g}rem"
    label = e("code", {"style": indent}, part_truth.text)
    track = Track(part_truth.text, TrackKind.SWITCH, _changes(part_truth))
    return truth_row(label, track, panel.view, end)


def _changes(part_truth: PartTruth) -> Course:
    """The truth of a subformula as the changes of a track; `None` means unknown."""
    stretches: Sequence[tuple[int, int, bool]] = sorted(
        [(a, b, True) for a, b in part_truth.true] + [(a, b, False) for a, b in part_truth.false]
    )
    changes: list[tuple[int, Scalar]] = []
    after: int | None = None
    for first, last, value in stretches:
        # Between known stretches the truth is unknown; without this the track would hold its value.
        if after is not None and first > after:
            changes.append((after, None))
        changes.append((first, value))
        after = last + 1
    if after is not None:
        changes.append((after, None))
    return Course.of(changes)


def has_unknown(panel: Panel) -> bool:
    """Whether a track of the panel has an unknown value in view."""
    view = panel.view
    return any(
        track.absent
        or track.between(view.start, view.end).has_unknown
        or (track.kind is not TrackKind.EVENT and track.value_at(view.start) is None)
        for track in panel.tracks
    )


class SpecLines(NamedTuple):
    """The lines of a requirement in its file."""

    place: str  # file name and number of the first line
    # of each line its number, and its text before, within and after the blamed subformula
    lines: Sequence[tuple[int, str, str, str]]


def spec_lines(requirement: Requirement, blame: Blame | None) -> SpecLines | None:
    """The requirement's text with line numbers; `None` if its place is not known."""
    span = requirement.span
    if span is None:
        return None
    lines = list(_lines(requirement, blame))
    return SpecLines(f"{span.source.name}:{lines[0][0]}", lines)


def _lines(requirement: Requirement, blame: Blame | None) -> Iterator[tuple[int, str, str, str]]:
    span = requirement.span
    assert span is not None, "it was asked for"
    text = span.source.text
    position = text.rfind("\n", 0, span.start) + 1
    last = span.start + len(text[span.start : span.end].rstrip())
    lines = text[position:last].split("\n")
    for number, line in enumerate(lines, span.line):
        has_more = number > span.line or len(lines) == 1
        if has_more or not line.endswith(f'"{requirement.text}"'):
            # A first line with only id and text is skipped, as the page has these already. Tabs are
            # expanded after the cut, as the blame counts characters of the file.
            before, failed, after = (part.expandtabs(4) for part in _marked(line, position, blame))
            yield number, before, failed, after
        position += len(line) + 1


def _marked(line: str, position: int, blame: Blame | None) -> tuple[str, str, str]:
    """A line that starts at `position` of the text, cut where its blame starts and ends."""
    if blame is None:
        return line, "", ""
    start = min(max(blame.start - position, 0), len(line))
    end = min(max(blame.end - position, 0), len(line))
    if not line[start:end].strip():
        return line, "", ""
    return line[:start], line[start:end], line[end:]


def headline(run: str, panel: Panel, origin: int) -> str:
    """One line on the outcome of a requirement in a run, or of one attempt.

    >>> from rvmon.report.time_axis import View
    >>> from rvmon.verdicts.attempt import Attempt
    >>> from rvmon.verdicts import Verdict
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
    why = reason_text(attempt, panel.late)
    reason = f": {with_moments(why, panel.view)}" if why else ""
    return f"{panel.requirement} {MARKS[attempt.verdict].word}, {run}{when}{reason}"
