"""The passing attempt that comes nearest to a failed one."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import TypeGuard

from rvmon.report.run_page import JudgedRun
from rvmon.report.timeline import Ghost
from rvmon.report.tracks import Track, TrackKind
from rvmon.report.view import View
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict

LOOKS = 60
"""Instants at which two runs are compared, evenly over the view."""

MOST = 100
"""Passing attempts that are compared, the first ones."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A run in which passing attempts of a requirement are looked for.

    Attributes:
        run: the run.
        tracks: of the signals that the requirement concerns.
    """

    run: JudgedRun
    tracks: tuple[Track, ...]


def nearest_passing(
    attempt: Attempt, tracks: Sequence[Track], view: View, candidates: Sequence[Candidate]
) -> Ghost | None:
    """The passing attempt whose signals differ least from those of a failed one.

    Both are laid over each other at their triggers. Two tracks differ by the share of the view
    over which their values are different, numbers by their mean distance over their range, events
    by how far apart they occur.
    """
    best: tuple[float, Candidate, Attempt] | None = None
    for candidate, passed in islice(_passing(attempt.requirement, candidates), MOST):
        shift = attempt.triggered - passed.triggered
        pairs = zip(tracks, candidate.tracks, strict=True)
        distance = sum(_distance(mine, other, view, shift) for mine, other in pairs)
        if best is None or distance < best[0]:
            best = (distance, candidate, passed)
    return None if best is None else _laid_over(best[1], best[2], attempt)


def _passing(
    requirement: str, candidates: Sequence[Candidate]
) -> Iterator[tuple[Candidate, Attempt]]:
    for candidate in candidates:
        for attempt in candidate.run.report.attempts:
            if attempt.requirement == requirement and attempt.verdict is Verdict.PASS:
                yield candidate, attempt


def _laid_over(candidate: Candidate, passed: Attempt, failed: Attempt) -> Ghost:
    shift = failed.triggered - passed.triggered
    moved = (
        replace(track, changes=tuple((t + shift, value) for t, value in track.changes))
        for track in candidate.tracks
    )
    end = candidate.run.report.end
    return Ghost(
        name=candidate.run.name,
        number=passed.number,
        tracks=tuple(moved),
        end=failed.triggered if end is None else end + shift,
        decided=None if passed.decided is None else passed.decided + shift,
    )


def _distance(mine: Track, other: Track, view: View, shift: int) -> float:
    """How much two tracks differ, from 0 (not at all) to 1, the other moved by `shift`."""
    if mine.kind is TrackKind.EVENT:
        return abs(_first(mine, view, 0) - _first(other, view, shift))
    instants = [view.start + (view.end - view.start) * look // (LOOKS - 1) for look in range(LOOKS)]
    pairs = [(mine.value_at(instant), other.value_at(instant - shift)) for instant in instants]
    numbers = [abs(value) for pair in pairs for value in pair if _is_number(value)]
    scale = max(numbers, default=0.0) or 1.0
    differences = (
        min(abs(a - b) / scale, 1.0) if _is_number(a) and _is_number(b) else float(a != b)
        for a, b in pairs
    )
    return sum(differences) / LOOKS


def _first(track: Track, view: View, shift: int) -> float:
    """Where in the view an event first occurs; at its end if it does not."""
    index = bisect_left(track.changes, view.start - shift, key=lambda change: change[0])
    if index == len(track.changes):
        return 1.0
    return min(view.fraction(track.changes[index][0] + shift), 1.0)


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)
