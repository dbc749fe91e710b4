"""The JSON text of attempts that were judged by columns: of those that are alike, together."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.monitor.columns.decided import DecidedAttempts, Decisions
from rvmon.monitor.explained.findings import Finding, Reasons
from rvmon.monitor.reasons.sentence import AfterTrigger, LastWith, Place, Turned
from rvmon.verdict.attempt_json import Pattern, attempt_text, numbers_texts
from rvmon.verdict.instants import formatted, seconds_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]


def texts_of(attempts: DecidedAttempts, origin: int) -> NDArray[np.object_]:
    """The texts of attempts, by number.

    Args:
        attempts: of one requirement.
        origin: the instant from which people count seconds, ticks.
    """
    decisions = attempts.decisions
    made = np.empty(len(attempts), object)
    for own in _alike(decisions, attempts.reasons):
        first = own.item(0)
        if decisions.passed[first] and not _looks_back(attempts.finding(first)):
            made[own] = _passed(attempts, own, origin)
        else:  # what failed, and when it was true before, is different for each
            made[own] = [attempt_text(attempts[index], origin) for index in own.tolist()]
    return made


def _alike(decisions: Decisions, reasons: Reasons) -> Iterator[Numbers]:
    """The places of attempts that differ in instants alone."""
    kind = decisions.passed.astype(np.int64)
    for column in (
        decisions.location,
        _regions(decisions, reasons),
        decisions.letter,
        decisions.seen_then,
        decisions.seen,
    ):
        if (column != column[:1]).any():
            number = _numbered(column)
            kind = _numbered(kind * (number.max() + 1) + number)
    order = np.argsort(kind, kind="stable")
    bounds = np.flatnonzero(np.diff(kind[order])) + 1
    return (own for own in np.split(order, bounds) if len(own))


def _numbered(column: Numbers) -> Numbers:
    """A number for each entry, the same for those that are equal; less than there are entries.

    `numpy.unique` would do, but brings arrays with masks into the process.
    """
    order = np.argsort(column, kind="stable")
    numbers = np.empty(len(column), np.int64)
    numbers[order[:1]] = 0
    numbers[order[1:]] = np.cumsum(np.diff(column[order]) != 0)
    return numbers


def _regions(decisions: Decisions, reasons: Reasons) -> Numbers:
    """Between which cuts of its location each attempt was when it was decided."""
    regions = np.zeros(len(decisions.number), np.int64)
    for location in set(decisions.location.tolist()):
        for cuts in reasons.cuts(location):  # one clock at most
            own = decisions.location == location
            ages = decisions.decided[own] - decisions.anchor[own]
            regions[own] = np.searchsorted(cuts, ages, "right")
    return regions


def _looks_back(finding: Finding) -> bool:
    """Whether its sentence speaks of what each attempt saw by itself."""
    return any(isinstance(part, LastWith | Turned | AfterTrigger) for part in finding.sentence)


def _passed(attempts: DecidedAttempts, own: Numbers, origin: int) -> list[str]:
    """The texts of attempts that passed and are alike."""
    decisions = attempts.decisions
    one = attempts[own.item(0)]
    finding = attempts.finding(own.item(0))
    triggered, decided, anchor = (
        column[own] for column in (decisions.triggered, decisions.decided, decisions.anchor)
    )
    columns: dict[str, Any] = {
        "number": decisions.number[own].tolist(),
        "triggered": triggered.tolist(),
        "decided": decided.tolist(),
    }
    columns["triggered_s"] = numbers_texts(seconds_of(triggered, origin))
    columns["decided_s"] = numbers_texts(seconds_of(decided, origin))
    if one.deadline is not None:
        columns["deadline"] = (anchor + (one.deadline - anchor.item(0))).tolist()
    start: Any = finding.start((anchor,), decided, triggered)
    parts = [part if isinstance(part, str) else None for part in finding.sentence]
    places = [
        formatted(part.ticks(decided, start))
        for part in finding.sentence
        if isinstance(part, Place)
    ]
    return Pattern(one, parts).texts(columns, places)
