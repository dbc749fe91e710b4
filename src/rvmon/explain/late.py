"""What was awaited in vain and came too late: found in the whole recording."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence

from rvmon.explain.spans import Spans
from rvmon.explain.truth_over_trace import subformulas
from rvmon.explain.truths import positions_of, truths_of
from rvmon.spec.checked.formula import Binary, BinaryOp, Formula, Unary, UnaryOp
from rvmon.spec.checked.specification import CheckedSpec, ForEach, Requirement
from rvmon.spec.checked.tense import has_future
from rvmon.spec.print.printer import format_formula
from rvmon.trace.sample import Sample, Scalar
from rvmon.verdict.attempt import Attempt

Known = dict[tuple[str, ForEach | None, tuple[tuple[str, Scalar], ...]], Spans]
"""Where formulas were true in a recording, by their text, `for each` and captured values."""


def awaited(requirement: Requirement, attempt: Attempt) -> Formula | None:
    """What a failed attempt had awaited when its window closed.

    Returns:
        `None` if that is not why it failed, or if what was awaited spoke of the future itself.
    """
    blame = attempt.blame
    if blame is None or blame.window[1] is None or attempt.decided is None:
        return None
    if attempt.decided <= blame.window[1]:
        return None
    for _, formula in subformulas(requirement.consequent, 0):
        match formula:
            case Unary(op=UnaryOp.EVENTUALLY, operand=part):
                pass
            case Binary(op=BinaryOp.UNTIL, right=part):
                pass
            case _:
                continue
        if format_formula(formula) == blame.subformula:
            return None if has_future(part) else part
    return None


def late_arrivals(
    spec: CheckedSpec,
    requirement: Requirement,
    attempts: Iterable[Attempt],
    samples: Sequence[Sample],
    end: int,
    names: frozenset[str] | None = None,
    *,
    known: Known | None = None,
) -> dict[int, int]:
    """By number of the attempt, when what it had awaited came true after the deadline, in ticks.

    Args:
        spec: the specification.
        requirement: one of its requirements.
        attempts: of that; those that missed no deadline, and those whose wait was never over, are
            left out.
        samples: the recording, in order.
        end: its last instant, ticks.
        names: the signals and events that have a source; `None`: all.
        known: what was found for other requirements in the same recording; it grows.

    Cost: one pass over the samples for each choice of captured values.
    """
    if not samples:
        return {}
    positions = positions_of(spec, samples, end)
    seen: Known = {} if known is None else known
    found = {}
    for attempt in attempts:
        formula = awaited(requirement, attempt)
        if formula is None or attempt.blame is None:
            continue
        key = (format_formula(formula), requirement.for_each, tuple(attempt.captured.items()))
        if key not in seen:
            each, captured = requirement.for_each, attempt.captured
            (truth,) = truths_of(
                spec, [formula], samples, end, names, for_each=each, captured=captured
            )
            seen[key] = truth.sure
        deadline = attempt.blame.window[1] or 0
        came = _first_after(deadline, seen[key], positions)
        if came is not None:
            found[attempt.number] = came
    return found


def _first_after(deadline: int, spans: Spans, positions: Sequence[int] | None) -> int | None:
    """The first position (`None`: every tick is one) after an instant that lies in a span."""
    place = bisect_right(spans, deadline, key=lambda span: span[1])
    for low, high in spans[place:]:
        first = max(low, deadline + 1)
        if positions is None:
            return first
        index = bisect_left(positions, first)
        if index < len(positions) and positions[index] <= high:
            return positions[index]
    return None
