"""The truth of each subformula over time: late responses, and triggers that came near."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from rvmon.analysis.example import small_step
from rvmon.analysis.spans import distinct, hold, outside, within
from rvmon.analysis.truths import (
    Question,
    RecordedTruths,
    Truth,
    look_through,
    parts_of,
    subformulas,
    truths_of_parts,
)
from rvmon.spec.checked.classify import has_future, is_end
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    BoundAtom,
    Constant,
    EventAtom,
    Formula,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.names_read import names_read
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.spec.print import format_formula
from rvmon.texts import listed
from rvmon.trace.sample import Sample
from rvmon.trace.time import format_instant
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
    attempts: Iterable[Attempt], waits: Mapping[int, Question], seen: RecordedTruths
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
    requirement: Requirement, attempt: Attempt, seen: RecordedTruths, start: int, stop: int
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


@dataclass(frozen=True, slots=True)
class _Miss:
    """The moment at which most parts of a conjunction were true.

    Attributes:
        parts: the operands of the conjunction.
        there: the operands that were true.
        at: the first such instant, ticks; `None` if no operand was ever true.
    """

    parts: tuple[Formula, ...]
    there: tuple[Formula, ...]
    at: int | None

    @property
    def missing(self) -> tuple[Formula, ...]:
        """The operands that were not true."""
        return tuple(part for part in self.parts if part not in self.there)


def why_not_triggered(
    spec: CheckedSpec,
    requirement: Requirement,
    samples: Iterable[Sample],
    end: int,
    names: frozenset[str] | None = None,
) -> str:
    """One sentence: the parts that the trigger lacked when it came nearest; "" if none applies.

    Args:
        spec: the specification.
        requirement: a requirement that was not triggered.
        samples: the recording, in order of time.
        end: its last instant, ticks.
        names: the signals and events that have a source; `None`: all.
    """
    question = parts_asked(requirement)
    return miss_in(spec, requirement, look_through(spec, [question], samples, end, names))


def parts_asked(requirement: Requirement) -> Question:
    """The operands of a trigger as a question; none for `for each`, which is not explained."""
    if requirement.for_each is not None:
        return Question(())
    return Question(tuple(dict.fromkeys(chain(*_options(requirement)))))


def miss_in(spec: CheckedSpec, requirement: Requirement, seen: RecordedTruths) -> str:
    """As `why_not_triggered`, from the truths of its `parts_asked` over a recording."""
    if seen.begin is None:
        return "the recording has no sample"
    if requirement.for_each is not None or is_end(requirement.trigger):
        return ""
    question = parts_asked(requirement)
    truths = dict(zip(question.formulas, seen.truths(question), strict=True))
    misses = [_miss(parts, truths) for parts in _options(requirement)]
    best = min(misses, key=lambda miss: len(miss.missing))
    if best.missing and best.at is None:
        valueless = _without_values(spec, best.parts, seen)
        return "; ".join(_apart(best.parts, truths, valueless, seen.begin, seen.end))
    return _sentence(best, truths, seen.begin)


def _options(requirement: Requirement) -> list[tuple[Formula, ...]]:
    """The disjuncts of a trigger, each as the operands of its conjunction."""
    return [_flat(part, BinaryOp.AND) for part in _flat(requirement.trigger, BinaryOp.OR)]


def _flat(formula: Formula, op: BinaryOp) -> tuple[Formula, ...]:
    match formula:
        case Binary(op=found, left=left, right=right) if found is op:
            return tuple(dict.fromkeys((*_flat(left, op), *_flat(right, op))))
        case _:
            return (formula,)


def _miss(parts: tuple[Formula, ...], seen: Mapping[Formula, Truth]) -> _Miss:
    """The instant with the most true operands; ties go to more events, then to the first."""
    instants = distinct([seen[part].sure[:, 0] for part in parts])
    if not len(instants):
        return _Miss(parts, (), None)
    true = np.array([hold(seen[part].sure, instants) for part in parts])
    events = true[[isinstance(part, EventAtom) for part in parts]].sum(axis=0)
    best = int(np.argmax(true.sum(axis=0) * (len(parts) + 1) + events))
    there = tuple(part for part, is_true in zip(parts, true[:, best], strict=True) if is_true)
    return _Miss(parts, there, int(instants[best]))


def _sentence(miss: _Miss, seen: Mapping[Formula, Truth], origin: int) -> str:
    """The sentence if some operand was true, or none is missing."""
    at = miss.at
    if at is None or not miss.missing:
        when = "" if at is None else f" at {format_instant(at, origin)}"
        return f"its trigger was true{when}, but not known to be false before: no edge was seen"
    rest = miss.there[0]
    for part in miss.there[1:]:
        rest = Binary(BinaryOp.AND, rest, part)
    unknown = any(hold(seen[part].may, at) for part in miss.missing)
    lacking = "was never known to be true" if unknown else "was never true"
    while_ = f"while `{format_formula(rest)}` was (first at {format_instant(at, origin)})"
    return f"{_either(miss.missing)} {lacking} {while_}"


def _apart(
    parts: tuple[Formula, ...],
    seen: Mapping[Formula, Truth],
    valueless: Mapping[str, str],
    start: int,
    end: int,
) -> Iterator[str]:
    """The clauses if no operand was ever true, with those on signals without a value."""
    groups: dict[str, list[Formula]] = {}
    for part in parts:
        word = "was never true"
        low, high = seen[part].may[0].tolist()
        if isinstance(part, SignalAtom) and part.name in valueless:
            word = valueless[part.name]
        elif low <= start and high >= end:
            word = "was never known"
        elif low <= end:
            word = "was never known to be true"
        elif isinstance(part, EventAtom):
            word = "never occurred"
        groups.setdefault(word, []).append(part)
    for word, own in groups.items():
        yield f"{_either(own)} {word}"
    signals = {part.name for part in parts if isinstance(part, SignalAtom)}
    for name in sorted(valueless.keys() - signals):
        yield f"`{name}` {valueless[name]}"


def _without_values(
    spec: CheckedSpec, parts: Sequence[Formula], seen: RecordedTruths
) -> Mapping[str, str]:
    """The signals without any value that the operands read, each with the clause for it."""
    read = {name for part in parts for name in names_read(part)} & spec.signals.keys()
    lacking = read & seen.valueless
    absent = set() if seen.names is None else lacking - seen.names
    return dict.fromkeys(absent, "has no source") | dict.fromkeys(
        lacking - absent, "never had a value"
    )


def _either(parts: Sequence[Formula]) -> str:
    return listed([f"`{format_formula(part)}`" for part in parts], "or")
