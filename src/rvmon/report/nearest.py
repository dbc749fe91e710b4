"""The passing attempt that comes nearest to a failed one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TypeGuard

from rvmon.report.run_page import JudgedRun
from rvmon.report.timeline import Ghost
from rvmon.report.tracks import Track, TrackKind
from rvmon.report.tracks_of import tracks_of
from rvmon.report.view import View
from rvmon.spec.checked import CheckedSpec
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict

LOOKS = 60
"""Instants at which two runs are compared, evenly over the view."""

MOST = 100
"""Passing attempts that are compared, the first ones."""


def nearest_passing(
    attempt: Attempt,
    tracks: Sequence[Track],
    view: View,
    spec: CheckedSpec,
    runs: Sequence[JudgedRun],
) -> Ghost | None:
    """The passing attempt whose signals differ least from those of a failed one.

    Both are laid over each other at their triggers. Two tracks differ by the share of the view
    over which their values are different, numbers by their mean distance over their range, events
    by how far apart they occur.

    Args:
        attempt: the failed one.
        tracks: of the signals concerned in its run.
        view: over which to compare.
        spec: that judged all runs.
        runs: in which to look.
    """
    best: tuple[float, Ghost] | None = None
    for count, (run, passed) in enumerate(_passing(attempt.requirement, runs)):
        if count == MOST:
            break
        ghost = _laid_over(run, passed, attempt, spec)
        distance = sum(
            _distance(mine, other, view) for mine, other in zip(tracks, ghost.tracks, strict=True)
        )
        if best is None or distance < best[0]:
            best = (distance, ghost)
    return None if best is None else best[1]


def _passing(requirement: str, runs: Sequence[JudgedRun]) -> Iterator[tuple[JudgedRun, Attempt]]:
    for run in runs:
        for attempt in run.report.attempts:
            if attempt.requirement == requirement and attempt.verdict is Verdict.PASS:
                yield run, attempt


def _laid_over(run: JudgedRun, passed: Attempt, failed: Attempt, spec: CheckedSpec) -> Ghost:
    shift = failed.triggered - passed.triggered
    requirement = spec.requirements[passed.requirement]
    tracks = tracks_of(spec, requirement, run.samples, run.report.health)
    moved = (
        replace(track, changes=tuple((t + shift, value) for t, value in track.changes))
        for track in tracks
    )
    end = failed.triggered if run.report.end is None else run.report.end + shift
    decided = None if passed.decided is None else passed.decided + shift
    return Ghost(run.name, passed.number, tuple(moved), end, decided)


def _distance(mine: Track, other: Track, view: View) -> float:
    """How much two tracks differ, from 0 (not at all) to 1."""
    if mine.kind is TrackKind.EVENT:
        return abs(_first(mine, view) - _first(other, view))
    instants = [view.start + (view.end - view.start) * look // (LOOKS - 1) for look in range(LOOKS)]
    pairs = [(mine.value_at(instant), other.value_at(instant)) for instant in instants]
    numbers = [abs(value) for pair in pairs for value in pair if _is_number(value)]
    scale = max(numbers, default=0.0) or 1.0
    differences = (
        min(abs(a - b) / scale, 1.0) if _is_number(a) and _is_number(b) else float(a != b)
        for a, b in pairs
    )
    return sum(differences) / LOOKS


def _first(track: Track, view: View) -> float:
    """Where in the view an event first occurs; behind its end if it does not."""
    return next((view.fraction(t) for t, _ in track.changes if view.start <= t <= view.end), 1.0)


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)
