"""An attempt taken apart: the truth of each subformula over its window."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.explain.example import small_step
from rvmon.explain.late_arrival import late_in, waits_of
from rvmon.explain.truths import (
    Seen,
    Spans,
    both,
    look_through,
    outside,
    parts_of,
    subformulas,
    truths_of_parts,
)
from rvmon.spec.checked.formula import BoundAtom, Constant, Formula
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.spec.print.printer import format_formula
from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Attempt


@dataclass(frozen=True, slots=True)
class PartTruth:
    """One subformula over the window.

    Attributes:
        depth: how deep it lies; 0 for what is required.
        text: as in the spec.
        part: `trigger` or `required`.
        true: the ticks of the window at which it is true.
        false: those at which it is false; at the others it is not known.
    """

    depth: int
    text: str
    part: str
    true: Spans
    false: Spans


@dataclass(frozen=True, slots=True)
class Breakdown:
    """An attempt taken apart.

    Attributes:
        attempt: its record.
        start: first tick of the window that is shown.
        end: its last tick.
        origin: from which people count seconds, ticks.
        late: when what it had awaited came after its deadline, ticks; `None` if it did not.
        part_truths: the trigger, then what is owed, each before its parts.
    """

    attempt: Attempt
    start: int
    end: int
    origin: int
    late: int | None
    part_truths: tuple[PartTruth, ...]


AROUND = 0.15
"""What is shown before the trigger and after the decision, as a share of what lies between."""


def dissect(
    spec: CheckedSpec,
    samples: Sequence[Sample],
    end: int,
    attempt: Attempt,
    names: frozenset[str] | None = None,
) -> Breakdown:
    """Take an attempt apart.

    Args:
        spec: the specification.
        samples: the recording, in order.
        end: the last instant of the recording, ticks.
        attempt: of one of its requirements on this recording.
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
    return Breakdown(attempt, start, stop, begin, late, part_truths)


def part_truths_of(
    requirement: Requirement, attempt: Attempt, seen: Seen, start: int, stop: int
) -> tuple[PartTruth, ...]:
    """The truth of the trigger, of what is owed, and of all their parts, over a stretch of time."""
    truths = truths_of_parts(requirement, attempt, seen)
    part_truths = []
    parts: list[tuple[str, Formula]] = [("required", requirement.consequent)]
    if not isinstance(requirement.trigger, BoundAtom) and requirement.trigger != Constant(True):
        parts.insert(0, ("trigger", requirement.trigger))
    for part, whole in parts:
        for depth, formula in subformulas(whole, 0):
            truth = truths[id(formula)]
            shown = ((start, stop),)
            true = both(truth.sure, shown)
            false = outside(both(truth.may, shown), start, stop)
            part_truths.append(PartTruth(depth, format_formula(formula), part, true, false))
    return tuple(part_truths)
