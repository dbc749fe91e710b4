"""What was awaited in vain and came too late: found in the whole recording."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Mapping, Sequence

from rvmon.explain.truths import Question, Seen, Spans, subformulas
from rvmon.spec.checked.classify import has_future
from rvmon.spec.checked.formula import Binary, BinaryOp, Formula, Unary, UnaryOp
from rvmon.spec.checked.specification import Requirement
from rvmon.spec.print.printer import format_formula
from rvmon.verdict.attempt import Attempt


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


def waits_of(requirement: Requirement, attempts: Iterable[Attempt]) -> dict[int, Question]:
    """By number of the attempt, what it had awaited in vain; see `awaited`."""
    return {
        attempt.number: Question((formula,), requirement.for_each, attempt.captured)
        for attempt in attempts
        if (formula := awaited(requirement, attempt)) is not None
    }


def late_in(
    attempts: Iterable[Attempt], waits: Mapping[int, Question], seen: Seen
) -> dict[int, int]:
    """By number of the attempt, when what it had awaited came true after the deadline, in ticks.

    Args:
        attempts: of a requirement; those that missed no deadline, and those whose wait was never
            over, are left out.
        waits: of these; see `waits_of`.
        seen: of the recording, which was looked through for the waits.
    """
    found = {}
    for attempt in attempts:
        if attempt.number not in waits or attempt.blame is None or seen.begin is None:
            continue
        (truth,) = seen.truths(waits[attempt.number])
        deadline = attempt.blame.window[1] or 0
        came = _first_after(deadline, truth.sure, seen.positions)
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
