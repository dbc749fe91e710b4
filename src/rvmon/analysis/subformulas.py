"""Dissection of an attempt: the truth of each subformula over time, and late responses."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rvmon.analysis.example import small_step
from rvmon.analysis.spans import outside, within
from rvmon.analysis.truths import (
    Question,
    Seen,
    look_through,
    parts_of,
    subformulas,
    truths_of_parts,
)
from rvmon.spec.checked.classify import has_future
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    BoundAtom,
    Constant,
    Formula,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.spec.print import format_formula
from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Attempt

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
    """By number of the attempt, the formula it awaited in vain; see `awaited`."""
    return {
        attempt.number: Question((formula,), requirement.for_each, attempt.captured)
        for attempt in attempts
        if (formula := awaited(requirement, attempt)) is not None
    }


def late_in(
    attempts: Iterable[Attempt], waits: Mapping[int, Question], seen: Seen
) -> dict[int, int]:
    """By number of the attempt, the instant (ticks) after the deadline when the response came.

    Attempts that missed no deadline, and those whose response never came, are left out.

    Args:
        attempts: the attempts of a requirement.
        waits: from `waits_of`.
        seen: the truths of the waits over the recording.
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


def _first_after(deadline: int, spans: NDArray[np.int64], positions: Positions) -> int | None:
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


@dataclass(frozen=True, slots=True)
class PartTruth:
    """The truth of one subformula over a stretch of time.

    Attributes:
        depth: its nesting depth; 0 for the trigger and the consequent.
        text: as in the specification.
        part: `trigger` or `required`.
        true: closed intervals of ticks at which it is true.
        false: those at which it is false; elsewhere it is unknown.
    """

    depth: int
    text: str
    part: str
    true: tuple[tuple[int, int], ...]
    false: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class Breakdown:
    """The dissection of an attempt.

    Attributes:
        attempt: its record.
        start: first tick shown.
        end: last tick shown.
        late: the instant (ticks) of a response after the deadline; `None` if there was none.
        part_truths: the trigger, then the consequent, each before its subformulas.
    """

    attempt: Attempt
    start: int
    end: int
    late: int | None
    part_truths: tuple[PartTruth, ...]


AROUND = 0.15
"""The margin shown before the trigger and after the decision, relative to the time between."""


def dissect(
    spec: CheckedSpec,
    samples: Sequence[Sample],
    end: int,
    attempt: Attempt,
    names: frozenset[str] | None = None,
) -> Breakdown:
    """Dissect an attempt.

    Args:
        spec: the specification.
        samples: the recording, in order of time.
        end: the last instant of the recording, ticks.
        attempt: an attempt of one of its requirements on this recording.
        names: the signals and events that have a source; `None`: all.

    Source: SEMANTICS 2; Kleene's value by a pessimistic and an optimistic reading (SEMANTICS 1).
    """
    requirement = spec.requirements[attempt.requirement]
    last = end if attempt.decided is None else attempt.decided
    length = last - attempt.triggered
    margin = max(int(length * AROUND), 2) if length else small_step(spec, [requirement])
    begin = samples[0].t
    start, stop = max(attempt.triggered - margin, begin), min(last + margin, end)
    waits = waits_of(requirement, [attempt])
    questions = [parts_of(requirement, attempt), *waits.values()]
    seen = look_through(spec, questions, samples, end, names)
    late = late_in([attempt], waits, seen).get(attempt.number)
    part_truths = part_truths_of(requirement, attempt, seen, start, stop)
    return Breakdown(attempt, start, stop, late, part_truths)


def part_truths_of(
    requirement: Requirement, attempt: Attempt, seen: Seen, start: int, stop: int
) -> tuple[PartTruth, ...]:
    """The truth of trigger, consequent and their subformulas, from `start` to `stop` (ticks)."""
    truths = truths_of_parts(requirement, attempt, seen)
    part_truths = []
    parts: list[tuple[str, Formula]] = [("required", requirement.consequent)]
    if not isinstance(requirement.trigger, BoundAtom | Constant):
        parts.insert(0, ("trigger", requirement.trigger))
    for part, whole in parts:
        for depth, formula in subformulas(whole, 0):
            truth = truths[id(formula)]
            true = within(truth.sure, start, stop)
            false = outside(within(truth.may, start, stop), start, stop)
            shown = [tuple((low, high) for low, high in one.tolist()) for one in (true, false)]
            part_truths.append(PartTruth(depth, format_formula(formula), part, *shown))
    return tuple(part_truths)
