"""Tracks: the signals and events of a requirement over time, for drawing; also scenes."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from enum import StrEnum
from itertools import groupby, pairwise
from operator import itemgetter

from msgspec import Struct

from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import Amount, Binary, Compare, Literal, SignalValue, Unary
from rvmon.language.checked.names_read import names_read
from rvmon.language.checked.specification import CheckedSpec, Requirement, Signal
from rvmon.report.changes import Changes, Course
from rvmon.report.time_axis import View
from rvmon.report.wording import value_text
from rvmon.trace.sample import Scalar
from rvmon.trace.schema import Kind
from rvmon.verdicts.attempt import Blame


class Outline(Struct, frozen=True):
    """The outline of a body: a convex polygon in the body's coordinates, metres."""

    body: str  # the body it belongs to; one that is not among the scene's bodies never moves
    corners: tuple[tuple[float, float], ...]  # one for a disc, two for a bar, more for a polygon
    radius: float  # the radius of rounded corners
    role: str  # its class in the page's style sheet


class Scene(Struct, frozen=True):
    """The motion of bodies in a vertical plane; between frames they stand still."""

    bodies: tuple[str, ...]  # in the order of each frame
    outlines: tuple[Outline, ...]  # drawn in this order
    # `(ticks, (x, z, angle) of each body, flattened)`, metres and radians
    frames: tuple[tuple[int, tuple[float, ...]], ...]
    view: tuple[float, float, float, float]  # the shown part: left, bottom, right, top in metres


def names_of_requirement(requirement: Requirement) -> tuple[str, ...]:
    """The names that a requirement reads, those of its trigger first, each once."""
    names = (
        name
        for formula in (requirement.trigger, requirement.consequent)
        for name in names_read(formula)
    )
    return tuple(dict.fromkeys(names))


def blamed_names(requirement: Requirement, blame: Blame) -> frozenset[str]:
    """The names that the blamed subformula reads; if none are found, those of the consequent."""
    parts = subformulas(requirement.consequent)
    # Only atoms read names. If the blame names an operator, all atoms below it count.
    required = [part for part in parts if not isinstance(part, Unary | Binary | Amount)]
    failed = [
        atom
        for atom in required
        if atom.span is not None and blame.start <= atom.span.start < blame.end
    ]
    return frozenset(name for atom in failed or required for name in names_read(atom))


def thresholds(requirement: Requirement, name: str) -> tuple[Threshold, ...]:
    """The constants that a requirement compares a signal with, each once."""
    each = [
        threshold
        for formula in (requirement.trigger, requirement.consequent)
        for atom in subformulas(formula)
        if isinstance(atom, Compare)
        for threshold in _thresholds(atom, name)
    ]
    return tuple(dict.fromkeys(each))


def _thresholds(atom: Compare, name: str) -> Iterator[Threshold]:
    match atom.left, atom.right:
        case SignalValue(name=read), Literal(value=value) if read == name:
            shown = atom.op.value
        case Literal(value=value), SignalValue(name=read) if read == name:
            shown = atom.op.mirrored.value
        case _:
            return
    if isinstance(value, int | float):
        yield Threshold(shown, float(value))


class TrackKind(StrEnum):
    """The kinds of drawing of a track."""

    SWITCH = "switch"
    EVENT = "event"
    NUMBER = "number"
    LABEL = "label"


class Threshold(Struct, frozen=True):
    """A comparison of the signal with a constant, in the signal's unit."""

    op: str
    value: float


class Track(Struct, frozen=True):
    """One signal or event over a run."""

    name: str  # as declared
    kind: TrackKind  # of drawing
    # `(ticks, value)` in order: the instant from which a signal has the value (`None`: unknown), or
    # at which an event occurred (`None`: perhaps)
    changes: Course
    unit: str = ""  # of a number
    thresholds: tuple[Threshold, ...] = ()  # the constants that the requirement compares it with
    absent: bool = False  # whether it has no source, so that it is unknown throughout

    def value_at(self, instant: int) -> Scalar:
        """A signal's value at an instant; `None` if it is unknown."""
        index = self.changes.count_until(instant)
        return self.changes[index - 1][1] if index else None

    def between(self, first: int, last: int) -> Course:
        """The changes from one instant to another, both included."""
        return self.changes[self.changes.count_until(first - 1) : self.changes.count_until(last)]


def signal_texts(tracks: Iterable[Track], instant: int) -> dict[str, str]:
    """The value of each signal at an instant, with its unit; events are left out.

    >>> force = Track("force", TrackKind.NUMBER, Course.of([(0, 40.5), (9, None)]), "N")
    >>> signal_texts([force], 3), signal_texts([force], 9)
    ({'force': '40.5 N'}, {'force': 'not known'})
    """
    texts = {}
    for track in tracks:
        if track.kind is not TrackKind.EVENT:
            texts[track.name] = value_text(track.value_at(instant), track.unit)
    return texts


PLACES = 400  # horizontal resolution of a track; denser changes are summarised per place
Point = tuple[float, float]  # x and y as fractions of a track, y downwards


class Stretch(Struct, frozen=True):
    """A stretch of a view over which a signal has one value."""

    left: float  # as a fraction of the view, 0 to 1
    right: float  # as a fraction of the view, 0 to 1
    value: Scalar  # `None` if it is unknown
    busy: bool = False  # whether it replaces several stretches that are too short to draw


def stretches(track: Track, view: View, end: int) -> list[Stretch]:
    """The values of a signal from a view's left edge to the end of the run or of the view."""
    stop = min(view.end, end)
    inside = track.between(view.start + 1, stop - 1)
    if track.kind is TrackKind.NUMBER:
        inside = inside.outlined(PLACES)
    changes = [(view.start, track.value_at(view.start)), *inside, (stop, None)]
    return [
        Stretch(view.fraction(t), view.fraction(after), value)
        for (t, value), (after, _) in pairwise(changes)
        if after > t
    ]


def readable(pieces: Sequence[Stretch]) -> list[Stretch]:
    """The stretches, with adjacent ones that are too narrow to see merged into a busy one."""
    if len(pieces) <= PLACES:
        return list(pieces)
    joined: list[Stretch] = []
    for narrow, group in groupby(pieces, lambda piece: piece.right - piece.left < 1 / PLACES):
        neighbours = list(group)
        if narrow and len(neighbours) > 1:
            joined.append(Stretch(neighbours[0].left, neighbours[-1].right, None, busy=True))
        else:
            joined.extend(neighbours)
    return joined


def occurrences(track: Track, view: View) -> list[tuple[float, Scalar]]:
    """The places in a view at which an event occurred (`True`) or may have (`None`)."""
    inside = [(view.fraction(t), value) for t, value in track.between(view.start, view.end)]
    if len(inside) <= PLACES:
        return inside
    return list({round(place * PLACES): (place, value) for place, value in inside}.values())


def polylines(pieces: Sequence[Stretch], lowest: float, highest: float) -> list[list[Point]]:
    """The steps of a number as lines, interrupted where it is unknown."""
    lines = []
    for known, group in groupby(pieces, key=lambda stretch: stretch.value is not None):
        if known:
            points = []
            for piece in group:
                y = share_of(float(piece.value or 0), highest, lowest)
                points += [(piece.left, y), (piece.right, y)]
            lines.append(points if len(points) <= 2 * PLACES else _outlined(points))
    return lines


def share_of(value: float, first: float, last: float) -> float:
    """The place of a number between two different ones: 0 at the first or beyond it, 1 at the last.

    >>> share_of(3.0, 1.0, 5.0), share_of(0.0, 1.7e308, -1.7e308), share_of(-2.0, 0.0, 1.0)
    (0.5, 0.5, 0.0)
    """
    within = min(max(value, min(first, last)), max(first, last))
    scale = 1.0 if math.isfinite(last - first) else 0.5
    return (within * scale - first * scale) / (last * scale - first * scale)


def _outlined(points: Sequence[Point]) -> list[Point]:
    """The first, last, lowest and highest point of each place, so that no peak is lost."""
    kept: list[Point] = []
    for _, group in groupby(points, key=lambda point: int(point[0] * PLACES)):
        same_place = list(group)
        # The first and the last keep the connections with the neighbours.
        extremes = [of(same_place, key=itemgetter(1)) for of in (min, max)]
        kept.extend(sorted({same_place[0], *extremes, same_place[-1]}))
    return kept


def tracks_of(
    spec: CheckedSpec,
    requirement: Requirement,
    changes: Mapping[str, Changes],
    absent: Collection[str] = (),
) -> tuple[Track, ...]:
    """The tracks of the signals and events that a requirement reads, in its order."""
    return tuple(
        _signal_track(spec.signals[name], requirement, changes[name])
        if name in spec.signals
        else Track(name, TrackKind.EVENT, changes[name].ended(), absent=name in absent)
        for name in names_of_requirement(requirement)
    )


def _signal_track(signal: Signal, requirement: Requirement, changes: Changes) -> Track:
    kinds = {Kind.BOOL: TrackKind.SWITCH, Kind.LABEL: TrackKind.LABEL}
    kind = kinds.get(signal.type.kind, TrackKind.NUMBER)
    limits = thresholds(requirement, signal.name)
    return Track(signal.name, kind, changes.ended(), signal.type.unit, limits)
