"""What an examination found, as diagnostics."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.analysis import rules
from rvmon.analysis.examine import Examination
from rvmon.analysis.subject import Conflict
from rvmon.diagnostics.diagnostic import Diagnostic, Label
from rvmon.diagnostics.span import Span
from rvmon.spec.checked import CheckedSpec, Requirement
from rvmon.spec.printer import format_duration
from rvmon.spec.rules.rule import finding


def findings_of(spec: CheckedSpec, found: Examination) -> list[Diagnostic]:
    """Diagnostics, in order of the file for single requirements, then conflicts, then the rest."""
    singles = [
        diagnostic
        for name in spec.requirements
        if name in found.possible
        for diagnostic in _single(spec, found, name)
    ]
    conflicts = [_conflict(spec, conflict) for conflict in found.conflicts]
    implied = [
        finding(
            rules.IMPLIED,
            f"{one.implied} fails only where {one.by} fails: it adds nothing",
            *_places(spec, one.implied, one.by),
            mend=f"drop {one.implied}, or look whether it was meant otherwise",
        )
        for one in found.implications
    ]
    return [*singles, *conflicts, *implied]


def _single(spec: CheckedSpec, found: Examination, name: str) -> Iterator[Diagnostic]:
    can, place = found.possible[name], _places(spec, name)
    if can.trigger is False:
        yield finding(
            rules.NEVER_TRIGGERS,
            f"nothing can trigger {name}",
            *place,
            mend="its trigger contradicts itself: look at the comparisons in it",
        )
        return
    if can.fail is False:
        yield finding(
            rules.NEVER_FAILS,
            f"{name} can never fail, whatever comes",
            *place,
            mend="give it a deadline with `within`, or say `at end: strong`",
        )
    if can.pass_ is False:
        yield finding(
            rules.NEVER_PASSES,
            f"{name} can never pass, whatever comes",
            *place,
            mend="what is owed contradicts itself or the trigger, whose instant counts",
        )


def _conflict(spec: CheckedSpec, conflict: Conflict) -> Diagnostic:
    ids = conflict.ids
    named = f"{', '.join(ids[:-1])} and {ids[-1]}"
    last = conflict.offsets[-1]
    when = f"{ids[-1]} {format_duration(last)} after {ids[0]}" if last else "at one instant"
    return finding(
        rules.CONFLICT,
        f"{named} cannot {'all' if len(ids) > 2 else 'both'} hold once they are triggered, {when}",
        *_places(spec, *ids),
        mend="narrow one of the triggers, or settle which one yields",
    )


def _places(spec: CheckedSpec, *names: str) -> Iterator[Label]:
    for name in names:
        span = _head(spec.requirements[name])
        if span is not None:
            yield Label(span)


def _head(requirement: Requirement) -> Span | None:
    """The first line of a requirement."""
    span = requirement.span
    if span is None:
        return None
    first = span.text.split("\n", 1)[0].rstrip()
    return Span(span.source, span.start, span.start + len(first))
