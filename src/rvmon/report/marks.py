"""Tracks within a view become a bounded number of things to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from rvmon.report.tracks import Track
from rvmon.report.view import View
from rvmon.trace.sample import Scalar

PLACES = 400
"""Places of a track that can be distinguished; what is denser is summed up at its place."""

Point = tuple[float, float]
"""x and y as fractions of a track, y downwards."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """A stretch of a view over which a signal has one value.

    Attributes:
        left: as a fraction of the view, 0 to 1.
        right: the same.
        value: `None` where it is unknown.
        busy: whether it stands for several values that are too short to be drawn.
    """

    left: float
    right: float
    value: Scalar
    busy: bool = False


def stretches(track: Track, view: View, end: int) -> list[Stretch]:
    """The values of a signal from a view's left edge to the end of the run or of the view.

    Args:
        track: of a signal.
        view: what is shown.
        end: the last instant of the run, ticks.
    """
    stop = min(view.end, end)
    inside = [(t, value) for t, value in track.changes if view.start < t < stop]
    changes = [(view.start, track.value_at(view.start)), *inside, (stop, None)]
    return [
        Stretch(view.fraction(t), view.fraction(after), value)
        for (t, value), (after, _) in pairwise(changes)
        if after > t
    ]


def readable(pieces: Sequence[Stretch]) -> list[Stretch]:
    """The same, with neighbours that are too narrow to be seen joined into busy ones."""
    if len(pieces) <= PLACES:
        return list(pieces)
    joined: list[Stretch] = []
    for narrow, group in groupby(pieces, key=lambda one: one.right - one.left < 1 / PLACES):
        some = list(group)
        if narrow and len(some) > 1:
            joined.append(Stretch(some[0].left, some[-1].right, None, busy=True))
        else:
            joined.extend(some)
    return joined


def occurrences(track: Track, view: View) -> list[tuple[float, Scalar]]:
    """Where in a view an event occurred (`True`), or may have (`None`); one per place."""
    inside = [
        (view.fraction(t), value) for t, value in track.changes if view.start <= t <= view.end
    ]
    if len(inside) <= PLACES:
        return inside
    return list({round(place * PLACES): (place, value) for place, value in inside}.values())


def polylines(pieces: Sequence[Stretch], lowest: float, highest: float) -> list[list[Point]]:
    """The steps of a number as lines, interrupted where it is unknown."""
    lines = []
    for known, group in groupby(pieces, key=lambda one: one.value is not None):
        if known:
            points = []
            for piece in group:
                value = min(max(float(piece.value or 0), lowest), highest)
                y = (highest - value) / (highest - lowest)
                points += [(piece.left, y), (piece.right, y)]
            lines.append(points if len(points) <= 2 * PLACES else _outlined(points))
    return lines


def _outlined(points: Sequence[Point]) -> list[Point]:
    """Of each place the first and last point and the extremes between, so that no peak is lost."""
    kept: list[Point] = []
    for _, group in groupby(points, key=lambda point: int(point[0] * PLACES)):
        some = list(group)
        extremes = (some[0], min(some, key=_height), max(some, key=_height), some[-1])
        kept.extend(sorted(dict.fromkeys(extremes)))
    return kept


def _height(point: Point) -> float:
    return point[1]
