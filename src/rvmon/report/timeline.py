"""The timeline of one attempt as HTML: obligation, axis, and a track per signal concerned."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.report.afterword import duration_text
from rvmon.report.markup import Child, e
from rvmon.report.style import MARKS
from rvmon.report.track_rows import place_of, track_row
from rvmon.report.tracks import Track
from rvmon.report.view import View, moment, round_instants, with_moments
from rvmon.verdict.attempt import Attempt

LABEL = 0.44
"""Share of the width that a label takes on a phone: those that would meet there get a row each."""


@dataclass(frozen=True, slots=True)
class Ghost:
    """The nearest passing attempt, laid over the failed one.

    Attributes:
        name: of its run.
        number: of the attempt.
        tracks: of its run, shifted in time so that both attempts are triggered together.
        end: of its run, shifted likewise.
        decided: shifted likewise.
    """

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
    ghost: Ghost | None = None,
) -> ET.Element:
    """Draw a timeline.

    Args:
        attempt: the one that it is about; `None` if there was none.
        tracks: of the signals and events concerned.
        view: what is shown.
        origin: the instant from which people count seconds, ticks.
        end: the last instant of the run, ticks.
        blamed: the names that the failed part of the requirement reads.
        late: when what the attempt had awaited came after its deadline, ticks.
        ghost: drawn behind the tracks, dashed.
    """
    ghosts = {track.name: track for track in ghost.tracks} if ghost else {}
    rows: list[Child] = []
    if attempt is not None:
        rows.append(_obligation(attempt, view, origin, end, late))
    for track in tracks:
        offending = _offending(attempt) if track.name in blamed else ()
        other = ghosts.get(track.name)
        rows.append(track_row(track, view, end, offending, other, ghost.end if ghost else end))
    rows.append(axis_row(view, origin))
    guides = [] if attempt is None else guides_of(attempt, view, end, late)
    overlay = e("div", {"class": "overlay"}, *guides, e("div", {"class": "cursor"}))
    return e("div", {"class": "timeline"}, *rows, overlay)


def _offending(attempt: Attempt | None) -> tuple[int, ...]:
    """What is to blame became so at `at`, perhaps before the window in which it mattered."""
    if attempt is None or attempt.blame is None:
        return ()
    return tuple(max(instant, attempt.blame.window[0]) for instant in attempt.blame.at)


def _obligation(
    attempt: Attempt, view: View, origin: int, end: int, late: int | None
) -> ET.Element:
    """The window in which something was owed, between labels of its instants."""
    first, last = _window(attempt)
    if last is None:
        last = attempt.decided  # nothing was owed any more
    left = view.fraction(first)
    right = min(view.fraction(max(end, first) if last is None else last), 1.0)
    kind = "window unbounded" if last is None else "window"
    bar = e("div", {"class": kind, "style": place_of(left, max(right - left, 0.0))})
    labels = _labels(attempt, view, origin, end, late)
    rows = 1 + max(row for _, row in labels)
    height = {"style": f"height:{rows * 1.35 + 0.9:g}rem"}
    plot = e("div", {"class": "plot owed", **height}, *(label for label, _ in labels), bar)
    return e("div", {"class": "row"}, e("div", {"class": "name unit"}, "window"), plot)


def _window(attempt: Attempt) -> tuple[int, int | None]:
    if attempt.blame is not None:
        return attempt.blame.window
    return attempt.triggered, attempt.deadline


def _labels(
    attempt: Attempt, view: View, origin: int, end: int, late: int | None
) -> list[tuple[ET.Element, int]]:
    """Labels of trigger, deadline, decision, late arrival: each in the first row with room."""
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
    taken: list[list[tuple[float, float]]] = []
    labels = []
    for instant, kind, sign, word in wanted:
        place = min(max(view.fraction(instant), 0.0), 1.0)
        to_left = place > 1 - LABEL
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
    """Lines through all rows at trigger, deadline, decision and late arrival."""
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
    """The row with the instants."""
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
