"""Draw a recording and its attempts, which rvmon judges when the site is built."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from html import escape

import rvmon

_WIDTH, _LEFT, _RIGHT, _ROW = 480, 76, 446, 32
_COLOURS = {"P": "#2e9e4f", "F": "#d64545", "I": "#c98a00"}
_MARKS = {"P": "✓ P", "F": "✗ F", "I": "? I"}
_SECOND = 1_000_000_000

Scale = Callable[[float], float]


def timeline(text: str) -> str:
    """An SVG of truth values, events and attempts.

    Args:
        text: a specification, a line `---`, and a recording as CSV with a column `t` of seconds,
            whose last row is the end; signals are truth values.
    """
    specification, _, table = text.partition("\n---\n")
    spec = rvmon.loads(specification)
    rows = list(csv.DictReader(table.splitlines()))
    times = [float(row["t"]) for row in rows]
    names = [name for name in rows[0] if name != "t"]
    samples = [
        (t, {name: _value(row[name]) for name in names if row[name]})
        for t, row in zip(times, rows, strict=True)
    ]
    report = spec.evaluate(samples)

    def scale(t: float) -> float:
        return _LEFT + (t - times[0]) / (times[-1] - times[0]) * (_RIGHT - _LEFT)

    tracks = []
    for name in names:
        changes = [(t, values[name]) for t, values in samples if name in values]
        draw = _events if name in spec.checked.events else _levels
        tracks.append((name, list(draw(changes, times, scale))))
    for name, verdict in report.verdicts.items():
        attempts = [one for one in report.attempts if one.requirement == name]
        bars = [
            _bar(one.triggered, one.decided, str(one.verdict), times[-1], scale) for one in attempts
        ]
        tracks.append((name, bars or [_text(_LEFT, 5, f"{verdict}: no attempt", "#888")]))
    return _picture(tracks, times, scale)


def _value(cell: str) -> bool | None:
    return {"nan": None, "true": True, "1": True}.get(cell, False)


def _levels(
    changes: Sequence[tuple[float, bool | None]], times: Sequence[float], scale: Scale
) -> Iterator[str]:
    """A track: high where true, low where false, a question mark where unknown."""
    born = changes[0][0] if changes else times[-1]
    given = [(times[0], None), *changes] if born > times[0] else list(changes)
    stretches = [
        one for one, before in zip(given, [(0.0, ""), *given], strict=False) if one[1] != before[1]
    ]
    ends = [t for t, _ in stretches[1:]] + [times[-1]]
    for (t, value), end in zip(stretches, ends, strict=True):
        left, right = scale(t), scale(end)
        if value is None:
            yield _box(left, -9, right - left, 18, "#8888", 'stroke-dasharray="3 2"', fill="none")
            yield _text((left + right) / 2 - 3, 4, "?", "#888")
        elif value:
            yield _box(left, -9, right - left, 18, "#4a7dc9", fill="#4a7dc9")
        else:
            yield f'<path d="M{left:.1f} 9H{right:.1f}" stroke="#4a7dc9" stroke-width="2"/>'


def _events(
    changes: Sequence[tuple[float, bool | None]], times: Sequence[float], scale: Scale
) -> Iterator[str]:
    yield f'<path d="M{scale(times[0]):.1f} 9H{scale(times[-1]):.1f}" stroke="#8888"/>'
    for t, value in changes:
        if value:
            yield f'<circle cx="{scale(t):.1f}" cy="0" r="5" fill="#4a7dc9"/>'


def _bar(triggered: int, decided: int | None, verdict: str, end: float, scale: Scale) -> str:
    """The bar of an attempt from trigger to decision; a line if both are the same instant."""
    left = scale(triggered / _SECOND)
    right = max(scale(end if decided is None else decided / _SECOND), left + 2)
    colour = _COLOURS[verdict]
    words = _MARKS[verdict]
    place = right + 4 if right + 30 < _WIDTH else left - 26
    bar = _box(left, -7, right - left, 14, colour, fill=f"{colour}44")
    return bar + _text(place, 5, words, colour)


def _box(
    x: float, y: float, width: float, height: float, stroke: str, more: str = "", *, fill: str
) -> str:
    size = f'x="{x:.1f}" y="{y}" width="{width:.1f}" height="{height}"'
    return f'<rect {size} stroke="{stroke}" fill="{fill}" fill-opacity="0.5" {more}/>'


def _text(x: float, y: float, words: str, fill: str = "currentColor", anchor: str = "start") -> str:
    place = f'x="{x:.1f}" y="{y}" fill="{fill}" text-anchor="{anchor}"'
    return f"<text {place}>{escape(words)}</text>"


def _picture(
    tracks: Sequence[tuple[str, Sequence[str]]], times: Sequence[float], scale: Scale
) -> str:
    height = _ROW * (len(tracks) + 1)
    parts = []
    for number, (name, shapes) in enumerate(tracks):
        y = _ROW * number + _ROW // 2
        label = _text(_LEFT - 8, 5, name, anchor="end")
        parts.append(f'<g transform="translate(0 {y})">{label}{"".join(shapes)}</g>')
    below = _ROW * len(tracks)
    last = 0.0
    for t in times:
        parts.append(f'<path d="M{scale(t):.1f} 0V{below}" stroke="#8884"/>')
        if scale(t) > last + 32:
            last = scale(t)
            parts.append(_text(last, below + 16, f"{t:g} s", anchor="middle"))
    said = ", ".join(name for name, _ in tracks)
    return (
        f'<svg class="timeline" role="img" aria-label="Timeline of {escape(said)}" '
        f'viewBox="0 0 {_WIDTH} {height}" xmlns="http://www.w3.org/2000/svg" '
        f'font-family="sans-serif" font-size="13">{"".join(parts)}</svg>'
    )
