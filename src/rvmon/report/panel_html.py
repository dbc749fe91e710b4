"""One attempt on the page of a run: sentence, spec line, timeline, values."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from itertools import groupby

from rvmon.explain.dissect import Strand
from rvmon.report.afterword import forecast_sentence, with_afterword, without_attempts
from rvmon.report.markup import Child, e, with_code
from rvmon.report.run_page import Panel, RunPage
from rvmon.report.style import MARKS
from rvmon.report.timeline import axis_row, guides_of, timeline, truth_row
from rvmon.report.tracks import Track, TrackKind, blamed_names
from rvmon.report.view import View, moment, with_moments
from rvmon.spec.checked.specification import Requirement
from rvmon.trace.sample import Scalar
from rvmon.verdict.attempt import Attempt, Blame
from rvmon.verdict.verdict import Verdict

DEEPEST = 8
"""Parts that lie deeper are not indented further."""


def parts_details(panel: Panel, origin: int, end: int) -> ET.Element | None:
    """A row for the trigger and for each part of what is owed; nothing if there are none.

    Args:
        panel: with strands.
        origin: the instant from which people count seconds, ticks.
        end: the last instant of the run, ticks.
    """
    if not panel.strands or panel.attempt is None:
        return None
    rows: list[Child] = []
    for part, strands in groupby(panel.strands, key=lambda strand: strand.part):
        rows.append(e("div", {"class": "part"}, part))
        rows += [_row(strand, panel, end) for strand in strands]
    rows.append(axis_row(panel.view, origin))
    overlay = e(
        "div",
        {"class": "overlay"},
        *guides_of(panel.attempt, panel.view, end, panel.late),
        e("div", {"class": "cursor"}),
    )
    open_ = panel.attempt.verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE)
    return e(
        "details",
        {"class": "parts", "open": open_},
        e("summary", None, "when each part of it was true"),
        e("div", {"class": "timeline"}, *rows, overlay),
        e(
            "p",
            {"class": "legend"},
            e("span", None, e("i", {"class": "key on"}), "true"),
            e("span", None, e("i", {"class": "key unknown"}), "not known"),
        ),
    )


def _row(strand: Strand, panel: Panel, end: int) -> ET.Element:
    indent = f"padding-left:{0.7 * min(strand.depth, DEEPEST):g}rem"
    label = e("code", {"style": indent}, strand.text)
    track = Track(strand.text, TrackKind.SWITCH, _changes(strand))
    return truth_row(label, track, panel.view, end)


def _changes(strand: Strand) -> tuple[tuple[int, Scalar], ...]:
    """From when on it is true, false, or not known."""
    stretches: Sequence[tuple[int, int, bool]] = sorted(
        [(a, b, True) for a, b in strand.true] + [(a, b, False) for a, b in strand.false]
    )
    changes: list[tuple[int, Scalar]] = []
    after: int | None = None
    for first, last, value in stretches:
        if after is not None and first > after:
            changes.append((after, None))
        changes.append((first, value))
        after = last + 1
    if after is not None:
        changes.append((after, None))
    return tuple(changes)


def panel_section(panel: Panel, panels: Sequence[Panel], content: RunPage) -> ET.Element:
    """Draw a panel."""
    report = content.run.report
    requirement = content.spec.requirements[panel.requirement]
    sentence = headline(content.run.name, panel, report.origin)
    end = report.origin if report.end is None else report.end
    blame = None if panel.attempt is None else panel.attempt.blame
    drawing = timeline(
        panel.attempt,
        panel.tracks,
        panel.view,
        origin=report.origin,
        end=end,
        blamed=frozenset() if blame is None else blamed_names(requirement, blame),
        late=panel.late,
        ghost=panel.ghost,
    )
    return e(
        "section",
        {"id": panel.id, "data-verdict": panel.verdict.value},
        e("h1", None, _badge(panel.verdict), e("span", None, *with_code(sentence))),
        e("p", {"class": "requirement"}, requirement.text) if requirement.text else None,
        spec_lines(requirement, blame),
        drawing,
        _cursor_controls(panel, report.origin),
        _legend(panel, content),
        parts_details(panel, report.origin, end),
        _values(panel.attempt),
        _siblings(panel, panels, content),
    )


def _badge(verdict: Verdict) -> ET.Element:
    return e(
        "span",
        {"class": "badge", "data-verdict": verdict.value},
        f"{verdict.value} {MARKS[verdict].sign}",
    )


def _cursor_controls(panel: Panel, origin: int) -> ET.Element:
    slider = {
        "type": "range",
        "min": 0,
        "max": 1000,
        "value": round(panel.view.fraction(panel.instant) * 1000),
        "aria-label": "instant shown",
    }
    return e(
        "div",
        {"class": "controls"},
        e("div", {"class": "name"}, e("button", {"class": "play", "type": "button"}, "▶ play")),
        e("div", {"class": "plot"}, e("input", slider)),
        e("output", {"class": "instant"}, moment(panel.instant, origin, panel.view)),
    )


def _legend(panel: Panel, content: RunPage) -> ET.Element | None:
    parts: list[Child] = []
    if not content.run.samples:
        parts.append("The signals of this run were not kept.")
    if panel.ghost is not None:
        decided = ""
        if panel.attempt is not None and panel.ghost.decided is not None:
            after = moment(panel.ghost.decided, panel.attempt.triggered, panel.view)
            decided = f", decided {after} after its trigger"
        parts.append(
            e(
                "span",
                None,
                e("i", {"class": "key ghost"}),
                f"nearest passing attempt: {panel.ghost.name}, attempt {panel.ghost.number}",
                decided,
            )
        )
    if any(_has_unknown(track, panel.view) for track in panel.tracks):
        parts.append(e("span", None, e("i", {"class": "key unknown"}), "unknown"))
    return e("p", {"class": "legend"}, *parts) if parts else None


def _has_unknown(track: Track, view: View) -> bool:
    if track.absent:
        return True
    inside = any(value is None and view.start <= t <= view.end for t, value in track.changes)
    return inside or (track.kind is not TrackKind.EVENT and track.value_at(view.start) is None)


def _values(attempt: Attempt | None) -> ET.Element | None:
    """The propositions at trigger and decision, and what was captured or is still owed."""
    if attempt is None:
        return None
    names = dict.fromkeys((*attempt.at_trigger, *attempt.at_decision))
    rows = [
        e(
            "tr",
            None,
            e("th", {"scope": "row"}, e("code", None, name)),
            e("td", None, _shown(attempt.at_trigger, name)),
            e("td", None, _shown(attempt.at_decision, name)),
        )
        for name in names
    ]
    details: list[Child] = []
    if rows:
        head = e("tr", None, e("th"), e("th", None, "at the trigger"), e("th", None, "at the end"))
        details.append(e("table", {"class": "values"}, head, *rows))
    details.extend(
        e("p", None, e("code", None, name), f" = {_scalar(value)} (captured at the trigger)")
        for name, value in attempt.captured.items()
    )
    if attempt.owed:
        details.append(e("p", None, "still owed: ", e("code", None, attempt.owed)))
    if attempt.forecast is not None:
        details.append(e("p", None, forecast_sentence(attempt.forecast)))
    if attempt.robustness is not None:
        details.append(e("p", None, f"robustness: {attempt.robustness:.4g}"))
    if not details:
        return None
    return e("details", None, e("summary", None, "values at trigger and decision"), *details)


def _siblings(panel: Panel, panels: Sequence[Panel], content: RunPage) -> ET.Element | None:
    """Links to the other attempts of the requirement, and how many are not shown."""
    if panel.attempt is None:
        return None
    own = [one for one in panels if one.requirement == panel.requirement and one.attempt]
    links = [
        e(
            "a",
            {
                "href": f"#{one.id}",
                "data-verdict": one.attempt.verdict.value,
                "aria-current": "true" if one is panel else None,
            },
            f"{one.attempt.numbered} {MARKS[one.attempt.verdict].sign}",
        )
        for one in own
        if one.attempt is not None
    ]
    counts = content.run.report.counts[panel.requirement]
    rest = sum(counts.values()) - len(links)
    if rest <= 0 and len(links) == 1:
        return None
    more = [f" and {rest} more"] if rest > 0 else []
    return e("p", {"class": "siblings"}, f"attempts of {panel.requirement}: ", *links, *more)


def _shown(values: Mapping[str, Scalar], name: str) -> str:
    return _scalar(values[name]) if name in values else ""


def _scalar(value: Scalar) -> str:
    if value is None:
        return "unknown"
    return str(value).lower() if isinstance(value, bool) else str(value)


def spec_lines(requirement: Requirement, blame: Blame | None) -> ET.Element | None:
    """The requirement's text with line numbers; `None` if its place is not known."""
    span = requirement.span
    if span is None:
        return None
    text = span.source.text
    first = text.rfind("\n", 0, span.start) + 1
    last = span.start + len(text[span.start : span.end].rstrip())
    block = e("pre", {"class": "spec"})
    position = first
    lines = text[first:last].split("\n")
    for number, line in enumerate(lines, span.line):
        if number == span.line and len(lines) > 1 and line.endswith(f'"{requirement.text}"'):
            position += len(line) + 1  # only id and text, which the page has already
            continue
        content = _marked(line, position, blame)
        gutter = e("span", {"class": "gutter", "aria-hidden": "true"}, f"{number:>3}  ")
        block.append(e("span", {"class": "line"}, gutter, *content))
        position += len(line) + 1
    place = f"{span.source.name}:{span.line}"
    return e("figure", {"class": "source"}, e("figcaption", None, place), block)


def _marked(line: str, position: int, blame: Blame | None) -> list[Child]:
    """A line that starts at `position` of the text, in three parts if it is to blame."""
    if blame is None:
        return [line]
    start = min(max(blame.start - position, 0), len(line))
    end = min(max(blame.end - position, 0), len(line))
    if not line[start:end].strip():
        return [line]
    failed = e("mark", {"title": "this part failed"}, line[start:end])
    return [line[:start], failed, line[end:]]


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
