"""Finds responses that came after their deadline."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping
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


def awaitable(requirement: Requirement) -> dict[str, Formula]:
    """The operand awaited by each `eventually` and `until` of the consequent, by their text.

    Operands that have future operators themselves are left out.
    """
    found: dict[str, Formula] = {}
    for _, formula in subformulas(requirement.consequent, 0):
        match formula:
            case (
                Unary(op=UnaryOp.EVENTUALLY, operand=part) | Binary(op=BinaryOp.UNTIL, right=part)
            ) if not has_future(part):
                found[format_formula(formula)] = part
    return found


def missed(attempt: Attempt) -> str:
    """The text of the subformula whose deadline was missed; empty if the cause was another one."""
    blame = attempt.blame
    if blame is None or blame.window[1] is None or attempt.decided is None:
        return ""
    return blame.subformula if attempt.decided > blame.window[1] else ""


def waits_of(requirement: Requirement, attempts: Iterable[Attempt]) -> dict[int, Question]:
    """By number of the attempt, a question for the formula it awaited when its window closed.

    Only attempts that missed the deadline of an `awaitable` subformula have one.
    """
    formulas = awaitable(requirement)
    return {
        attempt.number: Question((formula,), requirement.for_each, attempt.captured)
        for attempt in attempts
        if (formula := formulas.get(missed(attempt))) is not None
    }


def late_in(
    attempts: Iterable[Attempt], waits: Mapping[int, Question], seen: RecordedTruths
) -> dict[int, int]:
    """By number of the attempt, the instant (ticks) after the deadline at which the response came.

    Attempts that missed no deadline, and those whose response never came, are left out.
    """
    responses = {}
    for attempt in attempts:
        if attempt.number not in waits or attempt.blame is None or seen.first is None:
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
