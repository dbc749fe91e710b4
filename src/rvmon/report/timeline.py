"""The timeline of one attempt as HTML: obligation, axis, and a track per signal."""

from __future__ import annotations

import math
import sys
import xml.etree.ElementTree as ET
from collections.abc import Sequence

from msgspec import Struct

from rvmon.report.html import Child, e
from rvmon.report.time_axis import View, moment, round_instants, with_moments
from rvmon.report.tracks import (
    Stretch,
    Track,
    TrackKind,
    occurrences,
    polylines,
    readable,
    share_of,
    stretches,
)
from rvmon.report.wording import MARKS, duration_text
from rvmon.verdicts.attempt import Attempt

WIDTH, HEIGHT = 1000, 100
"""The size of a number's drawing in SVG units; it is stretched to the width of the page."""

SIGNS = {"<=": "≤", ">=": "≥", "==": "=", "!=": "≠"}  # comparison signs for display
EDGE = 0.12  # the margin above and below, relative to a number's range
MOST = sys.float_info.max
LABELLED = 0.25  # the share of the width, at the right, taken by the label of a threshold

LOWEST_UNDER = 0.75
"""The lowest threshold, from the top of a track, that has room for its label below."""


def track_row(
    track: Track,
    view: View,
    end: int,
    blamed: Sequence[int],
    reference: Track | None,
    reference_end: int,
) -> ET.Element:
    """Draw one track.

    `blamed` are the instants of offending samples; `reference` is the same signal in another run,
    drawn in the background.
    """
    plot = e("div", {"class": f"plot {track.kind.value}"})
    if track.absent:
        plot.append(_unknown(0.0, 1.0))
    elif track.kind is TrackKind.EVENT:
        _add_event(plot, track, view, blamed, reference)
    elif track.kind is TrackKind.NUMBER:
        _add_number(plot, track, view, end, blamed, reference, reference_end)
    else:
        _add_stretches(plot, stretches(track, view, end))
        for instant in blamed:
            if view.start <= instant <= view.end:
                plot.append(_ring(view.fraction(instant)))
        if reference is not None:
            _add_stretches(plot, stretches(reference, view, reference_end), " reference")
    unit = e("small", None, f" [{track.unit}]") if track.unit else None
    name = e("div", {"class": "name"}, e("span", None, e("code", None, track.name), unit))
    if track.kind is not TrackKind.EVENT:
        name.append(e("output", {"data-track": track.name}))
    return e("div", {"class": "row"}, name, plot)


def truth_row(label: ET.Element, track: Track, view: View, end: int) -> ET.Element:
    """Draw when a formula was true."""
    plot = e("div", {"class": "plot switch truth"})
    # A truth holds over whole ticks, so that of the last tick ends one tick later.
    _add_stretches(plot, stretches(track, view, end + 1))
    return e("div", {"class": "row"}, e("div", {"class": "name"}, label), plot)


def _add_event(
    plot: ET.Element, track: Track, view: View, blamed: Sequence[int], reference: Track | None
) -> None:
    if reference is not None:
        for place, _ in occurrences(reference, view):
            plot.append(e("span", {"class": "mark reference", "style": f"left:{place:.2%}"}, "◇"))
    offending = {view.fraction(t) for t in blamed}
    for place, value in occurrences(track, view):
        sign = "?" if value is None else "◆"
        plot.append(e("span", {"class": "mark", "style": f"left:{place:.2%}"}, sign))
        if place in offending:
            plot.append(_ring(place))


def _add_stretches(plot: ET.Element, pieces: Sequence[Stretch], extra: str = "") -> None:
    for piece in readable(pieces):
        width = piece.right - piece.left
        place = {"style": place_of(piece.left, width)}
        if piece.busy:
            plot.append(e("div", {"class": f"busy{extra}", "title": "changes too fast", **place}))
        elif piece.value is None:
            # Hatching where the reference is unknown would hide known values of this run.
            if not extra:
                plot.append(_unknown(piece.left, width))
        elif piece.value is True:
            plot.append(e("div", {"class": f"on{extra}", **place}))
        elif isinstance(piece.value, str):
            plot.append(e("div", {"class": f"state{extra}", **place}, piece.value))


def _add_number(
    plot: ET.Element,
    track: Track,
    view: View,
    end: int,
    blamed: Sequence[int],
    reference: Track | None,
    reference_end: int,
) -> None:
    pieces = stretches(track, view, end)
    others = [] if reference is None else stretches(reference, view, reference_end)
    low, high = _range([*pieces, *others], track)
    edge = high * EDGE - low * EDGE
    lowest, highest = max(low - edge, -MOST), min(high + edge, MOST)
    drawing = e(
        "svg",
        {"viewBox": f"0 0 {WIDTH} {HEIGHT}", "preserveAspectRatio": "none", "aria-hidden": "true"},
    )
    for kind, stretches_of_run in (("reference", others), ("line", pieces)):
        for points in polylines(stretches_of_run, lowest, highest):
            places = " ".join(f"{x * WIDTH:.4g},{y * HEIGHT:.3g}" for x, y in points)
            drawing.append(e("polyline", {"class": kind, "points": places}))
    plot.append(drawing)
    constants = {threshold.value for threshold in track.thresholds}
    # A bound equal to a threshold needs no label: that of the threshold is at the same height.
    for bound in sorted({low, high} - constants):
        top = share_of(bound, highest, lowest)
        plot.append(e("span", {"class": "scale", "style": f"top:{top:.2%}"}, f"{bound:.3g}"))
    for piece in pieces:
        if piece.value is None:
            plot.append(_unknown(piece.left, piece.right - piece.left))
    for threshold in track.thresholds:
        top = share_of(threshold.value, highest, lowest)
        text = f"{SIGNS.get(threshold.op, threshold.op)} {threshold.value:g} {track.unit}".rstrip()
        # If the line runs above the threshold, a label above it would cover the line.
        side = " under" if top < LOWEST_UNDER and _is_above(pieces, threshold.value) else ""
        line = {"class": f"threshold{side}", "style": f"top:{top:.2%}"}
        plot.append(e("div", line, e("span", None, text)))
    for instant in blamed:
        at = track.value_at(instant)
        if isinstance(at, int | float) and view.start <= instant <= view.end:
            x, y = view.fraction(instant), share_of(at, highest, lowest)
            plot.append(e("span", {"class": "sample", "style": f"left:{x:.2%};top:{y:.2%}"}, "✗"))


def _is_above(pieces: Sequence[Stretch], value: float) -> bool:
    """Whether the line is above a threshold where the threshold's label is placed."""
    values = [piece.value for piece in pieces if piece.right > 1 - LABELLED]
    return any(isinstance(one, int | float) and one > value for one in values)


def _range(pieces: Sequence[Stretch], track: Track) -> tuple[float, float]:
    """The range of a number's track: all finite values in view, and the thresholds."""
    values = [float(piece.value) for piece in pieces if isinstance(piece.value, int | float)]
    values = [value for value in values if math.isfinite(value)]
    values += [threshold.value for threshold in track.thresholds]
    low, high = min(values, default=0.0), max(values, default=1.0)
    if low < high:
        return low, high
    around = max(1.0, abs(low) * EDGE)  # relative, as adding 1 to a large number is no change
    return max(low - around, -MOST), min(high + around, MOST)


def _ring(place: float) -> ET.Element:
    return e("span", {"class": "mark offending", "style": f"left:{place:.2%}"})


def place_of(left: float, width: float) -> str:
    """The CSS position of an element within a track, from fractions of its width."""
    return f"left:{left:.3%};width:{width:.3%}"


def _unknown(left: float, width: float) -> ET.Element:
    return e("div", {"class": "unknown", "title": "unknown", "style": place_of(left, width)})


LABEL = 0.44  # the share of the width that a label takes on a phone


class ReferenceAttempt(Struct, frozen=True):
    """The nearest passing attempt, moved in time so that both triggers coincide; in ticks."""

    name: str
    number: int
    tracks: tuple[Track, ...]
    end: int
    decided: int | None


def timeline(
    attempt: Attempt | None,
    tracks: Sequence[Track],
    view: View,
    *,
    origin: int,
    end: int,
    blamed: frozenset[str] = frozenset(),
    late: int | None = None,
    reference: ReferenceAttempt | None = None,
) -> ET.Element:
    """Draw a timeline.

    Args:
        attempt: the attempt; `None` if the requirement has none.
        tracks: of the signals and events that the requirement reads.
        view: the shown part.
        origin: the instant that is shown as 0 s, ticks.
        end: the last instant of the run, ticks.
        blamed: the names that the blamed subformula reads.
        late: the instant of a response after the deadline, ticks.
        reference: an attempt of another run, drawn dashed in the background.
    """
    references = {track.name: track for track in reference.tracks} if reference else {}
    rows: list[Child] = []
    if attempt is not None:
        rows.append(_obligation(attempt, view, origin, end, late))
    for track in tracks:
        offending = _offending(attempt) if track.name in blamed else ()
        other, other_end = references.get(track.name), reference.end if reference else end
        rows.append(track_row(track, view, end, offending, other, other_end))
    rows.append(axis_row(view, origin))
    guides = [] if attempt is None else guides_of(attempt, view, end, late)
    overlay = e("div", {"class": "overlay"}, *guides, e("div", {"class": "cursor"}))
    return e("div", {"class": "timeline"}, *rows, overlay)


def _offending(attempt: Attempt | None) -> tuple[int, ...]:
    """The blamed instants; those of a value from before the window are moved to its start."""
    if attempt is None or attempt.blame is None:
        return ()
    return tuple(max(instant, attempt.blame.window[0]) for instant in attempt.blame.at)


def _obligation(
    attempt: Attempt, view: View, origin: int, end: int, late: int | None
) -> ET.Element:
    """The row with the window of the obligation and the labels of its instants."""
    first, last = _window(attempt)
    if last is None:
        last = attempt.decided  # the decision ended the obligation
    left = view.fraction(first)
    right = min(view.fraction(max(end, first) if last is None else last), 1.0)
    kind = "window unbounded" if last is None else "window"
    bar = e("div", {"class": kind, "style": place_of(left, max(right - left, 0.0))})
    labels = _labels(attempt, view, origin, end, late)
    rows = 1 + max(row for _, row in labels)
    height = {"style": f"height:{rows * 1.35 + 0.9:g}rem"}
    plot = e("div", {"class": "plot required", **height}, *(label for label, _ in labels), bar)
    return e("div", {"class": "row"}, e("div", {"class": "name unit"}, "window"), plot)


def _window(attempt: Attempt) -> tuple[int, int | None]:
    if attempt.blame is not None:
        return attempt.blame.window
    return attempt.triggered, attempt.deadline


def _labels(
    attempt: Attempt, view: View, origin: int, end: int, late: int | None
) -> list[tuple[ET.Element, int]]:
    """The labels of trigger, deadline, decision and late response, each with its row."""
    wanted = [(attempt.triggered, "trigger", "▼", "trigger")]
    deadline = _window(attempt)[1]
    if deadline is not None and deadline != attempt.triggered:
        wanted.append((deadline, "deadline", "|", "deadline"))
    if attempt.decided is not None:
        mark = MARKS[attempt.verdict]
        wanted.append((attempt.decided, "decision", mark.sign, mark.word))
    else:
        wanted.append((end, "end", "■", "end of the run"))
    if late is not None and deadline is not None:
        sign = "◆" if late <= view.end else "→"
        word = with_moments(f"came {duration_text(late - deadline)} late", view)
        wanted.append((late, "late", sign, word))
    # In order of importance, each in the topmost row with free space. The layout is computed
    # without a browser, so for the narrowest screen.
    taken: list[list[tuple[float, float]]] = []
    labels = []
    for instant, kind, sign, word in wanted:
        place = min(max(view.fraction(instant), 0.0), 1.0)
        to_left = place > 1 - LABEL  # to the right, the edge of the page would cut its words off
        left, right = (place - LABEL, place) if to_left else (place, place + LABEL)
        row = next(
            (i for i, used in enumerate(taken) if all(right <= a or left >= b for a, b in used)),
            len(taken),
        )
        if row == len(taken):
            taken.append([])
        taken[row].append((left, right))
        side = " to-left" if to_left else ""
        attributes = {
            "class": f"label {kind}{side}",
            "data-verdict": attempt.verdict.value,
            "style": f"left:{place:.2%};top:{row * 1.35:g}rem",
        }
        text: list[Child] = [
            f"{word} ",
            e("span", {"class": "when"}, moment(instant, origin, view)),
        ]
        labelled = [*text, f" {sign}"] if to_left else [f"{sign} ", *text]
        labels.append((e("div", attributes, *labelled), row))
    return labels


def guides_of(attempt: Attempt, view: View, end: int, late: int | None) -> list[ET.Element]:
    """The lines through all rows at trigger, deadline, decision and late response."""
    wanted = [("trigger", attempt.triggered), ("deadline", _window(attempt)[1]), ("late", late)]
    wanted.append(("end", end) if attempt.decided is None else ("decision", attempt.decided))
    return [
        e(
            "div",
            {
                "class": f"guide {kind}",
                "data-verdict": attempt.verdict.value,
                "style": f"left:{view.fraction(instant):.2%}",
            },
        )
        for kind, instant in wanted
        if instant is not None and view.start <= instant <= view.end
    ]


def axis_row(view: View, origin: int) -> ET.Element:
    """The row of the time axis."""
    ticks = [
        e(
            "span",
            {"class": "tick", "style": f"left:{view.fraction(instant):.2%}"},
            moment(instant, origin, view).removesuffix(" s"),
        )
        for instant in round_instants(view, origin)
        if 0.01 <= view.fraction(instant) <= 0.99
    ]
    axis = e("div", {"class": "plot axis"}, *ticks)
    return e("div", {"class": "row"}, e("div", {"class": "name unit below"}, "time, s"), axis)
