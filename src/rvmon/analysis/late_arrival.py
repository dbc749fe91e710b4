"""Responses that came after their deadline."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from rvmon.analysis.truths import Question, RecordedTruths, subformulas
from rvmon.language.checked.classify import has_future
from rvmon.language.checked.formula import Binary, BinaryOp, Formula, Unary, UnaryOp
from rvmon.language.checked.specification import Requirement
from rvmon.language.print import format_formula
from rvmon.verdicts.attempt import Attempt

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.analysis.truths import Positions


def awaited(requirement: Requirement, attempt: Attempt) -> Formula | None:
    """The formula that a failed attempt awaited when its window closed.

    Returns:
        `None` if it did not fail by a closed window, or if the formula has a future operator.
    """
    blame = attempt.blame
    if blame is None or blame.window[1] is None or attempt.decided is None:
        return None
    if attempt.decided <= blame.window[1]:
        return None
    for formula, part in _waits_in(requirement):
        if format_formula(formula) == blame.subformula:
            return None if has_future(part) else part
    return None


def may_be_awaited(requirement: Requirement) -> Iterator[Formula]:
    """The formulas that `awaited` may give for attempts of a requirement."""
    return (part for _, part in _waits_in(requirement) if not has_future(part))


def _waits_in(requirement: Requirement) -> Iterator[tuple[Formula, Formula]]:
    """The subformulas of its consequent that await something, each with that."""
    for _, formula in subformulas(requirement.consequent, 0):
        match formula:
            case Unary(op=UnaryOp.EVENTUALLY, operand=part):
                yield formula, part
            case Binary(op=BinaryOp.UNTIL, right=part):
                yield formula, part


def waits_of(requirement: Requirement, attempts: Iterable[Attempt]) -> dict[int, Question]:
    """By number of the attempt, the formula it awaited in vain; see `awaited`."""
    return {
        attempt.number: Question((formula,), requirement.for_each, attempt.captured)
        for attempt in attempts
        if (formula := awaited(requirement, attempt)) is not None
    }


def late_in(
    attempts: Iterable[Attempt], waits: Mapping[int, Question], seen: RecordedTruths
) -> dict[int, int]:
    """By number of the attempt, the instant (ticks) after the deadline when the response came.

    Attempts that missed no deadline, and those whose response never came, are left out.
    """
    responses = {}
    for attempt in attempts:
        if attempt.number not in waits or attempt.blame is None or seen.begin is None:
            continue
        (truth,) = seen.truths(waits[attempt.number])
        deadline = attempt.blame.window[1] or 0
        came = first_after(deadline, truth.true, seen.positions)
        if came is not None:
            responses[attempt.number] = came
    return responses


def first_after(deadline: int, spans: NDArray[np.int64], positions: Positions) -> int | None:
    """The first position after `deadline` that lies in a span; `None` if there is none."""
    for place in range(int(np.searchsorted(spans[:, 1], deadline, "right")), len(spans)):
        low, high = (int(edge) for edge in spans[place])
        first = max(low, deadline + 1)
        if positions is None:
            return first
        index = bisect_left(positions, first)
        if index < len(positions) and positions[index] <= high:
            return int(positions[index])
    return None
