"""Example timelines drawn in the terminal: a track per name, a column per instant."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from rvmon.explain.example import Example
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.spec.print.printer import format_duration
from rvmon.trace.sample import Scalar, Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from rich.text import Text

HIGH, LOW, NOBODY_KNOWS, OCCURS = "▇", "▁", "?", "●"
NARROWEST = 9
"""Characters of a column at least."""

WIDTH = 80


def picture_of(example: Example, spec: CheckedSpec, concerned: Collection[str]) -> list[Text]:
    """The lines of a drawing, at most 80 columns wide if that is possible.

    Times are not to scale: every instant at which something happens has a column.
    """
    from rich.text import Text

    instants = _instants(example)
    names = [name for name in (*spec.signals, *spec.events) if name in concerned]
    heads = [*names, *example.verdicts, "time"]
    margin = max(len(head) for head in heads) + 4
    labels = [label_of(t) for t in instants]
    cells = {name: _cells(name, example, spec, instants) for name in names}
    widest = max([len(label) for label in labels] + [len(c) for row in cells.values() for c in row])
    room = (WIDTH - margin) // len(instants)
    width = max(min(max(widest + 2, NARROWEST), room), 4)
    legend = legend_of(labels)
    lines = [
        Text.assemble(
            (f"  {'time':<{margin - 2}}", "dim"),
            ("".join(f"{label:<{width}}" for label in labels).rstrip(), "dim"),
            (f"   ({legend})" if legend else "", "dim"),
        )
    ]
    for name in names:
        drawn = "".join(_fill(cell, width) for cell in cells[name])
        lines.append(Text(f"  {name:<{margin - 2}}{drawn.rstrip()}"))
    for name in example.verdicts:
        lines += _verdict_lines(name, example, instants, margin, width)
    return lines


def _instants(example: Example) -> list[int]:
    found = {sample.t for sample in example.samples} | {example.end}
    for attempt in example.attempts:
        found |= {attempt.triggered}
        found |= set() if attempt.decided is None else {attempt.decided}
    return sorted(found)


def _cells(name: str, example: Example, spec: CheckedSpec, instants: Sequence[int]) -> list[str]:
    """What stands in each column: a text, or one character that fills it."""
    given = {sample.t: sample.values[name] for sample in example.samples if name in sample.values}
    if name in spec.events:
        return [_occurrence(given.get(t, False)) for t in instants]
    stale_after = spec.signals[name].stale_after
    cells: list[str] = []
    before = ""
    value: Value = None
    at = 0
    for t in instants:
        if t in given:
            value, at = given[t], t
        stale = stale_after is not None and t - at > stale_after
        shown = _scalar(None if stale or isinstance(value, Mapping | tuple) else value)
        unit = spec.signals[name].type.unit
        text = f"{shown} {unit}" if unit and shown not in (HIGH, LOW, NOBODY_KNOWS) else shown
        plain = text in (HIGH, LOW, NOBODY_KNOWS)
        cells.append("─" if text == before and not plain else text)
        before = text
    return cells


def _scalar(value: Scalar) -> str:
    match value:
        case bool():
            return HIGH if value else LOW
        case None:
            return NOBODY_KNOWS
        case int() | float():
            return f"{value:.6g}"
        case str():
            return value


def _occurrence(value: Value) -> str:
    if value is False:
        return "·"
    if value is None:
        return NOBODY_KNOWS
    if isinstance(value, Mapping) and value:
        return OCCURS + " " + " ".join(f"{key}={_payload(v)}" for key, v in value.items())
    return OCCURS + " "


def _payload(value: Scalar) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _fill(cell: str, width: int) -> str:
    if cell in (HIGH, LOW, NOBODY_KNOWS, "─"):
        return cell * width
    if cell == "·":
        return f"{cell:<{width}}"
    filler = " " if cell.startswith(OCCURS) else "─"
    text = cell if len(cell) < width else cell[: width - 2] + "…"
    return (text + " ").ljust(width, filler) if filler == "─" else text.ljust(width)


def _verdict_lines(
    name: str, example: Example, instants: Sequence[int], margin: int, width: int
) -> list[Text]:
    from rich.text import Text

    from rvmon.report.style import MARKS

    own = [attempt for attempt in example.attempts if attempt.requirement == name]
    if not own:
        mark = MARKS[Verdict.NOT_TRIGGERED]
        return [Text(f"  {name:<{margin - 2}}{mark.sign} NT no attempt", style=mark.terminal)]
    lines = []
    for attempt in own:
        head = name if len(own) == 1 else f"{name} #{attempt.number}"
        mark = MARKS[attempt.verdict]
        drawn = _attempt(attempt, example, instants, width)
        verdict = f"{mark.sign} {attempt.verdict.value}"
        lines.append(Text.assemble(f"  {head:<{margin - 2}}{drawn}", (verdict, mark.terminal)))
    return lines


def _attempt(attempt: Attempt, example: Example, instants: Sequence[int], width: int) -> str:
    """From the trigger to the decision, or the end of the run."""
    first = instants.index(attempt.triggered)
    last = instants.index(example.end if attempt.decided is None else attempt.decided)
    if first == last:
        return " " * (first * width) + "▼ "
    return " " * (first * width) + "▼" + "┄" * ((last - first) * width - 2) + " "


def label_of(t: int) -> str:
    """An instant; one that is a tick beside a rounder one takes a sign for that.

    >>> label_of(3_000_000_001), label_of(199_999_999), label_of(0), label_of(1_500_000_000)
    ('3 s⁺', '200 ms⁻', '0 s', '1500 ms')
    """
    if t < 1000 or not (t + 1) % 1000:
        return f"{format_duration(t + 1)}⁻" if t >= 1000 else format_duration(t)
    return f"{format_duration(t - 1)}⁺" if t % 1000 == 1 else format_duration(t)


def legend_of(labels: list[str]) -> str:
    """What the signs in some labels mean, or empty."""
    signs = {"⁺": "after", "⁻": "before"}
    used = [
        f"{sign} a tick {word}" for sign, word in signs.items() if any(sign in x for x in labels)
    ]
    return ", ".join(used)
