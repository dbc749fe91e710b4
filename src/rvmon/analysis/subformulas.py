"""Explains attempts by the truth of each subformula, and finds near misses of triggers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from rvmon.analysis.example import small_step
from rvmon.analysis.interval_sets import distinct, hold, within
from rvmon.analysis.late_arrival import late_in, waits_of
from rvmon.analysis.truths import (
    Question,
    RecordedTruths,
    Truth,
    look_through,
    parts_of,
    subformulas,
    truths_of_parts,
)
from rvmon.language.checked import formula as formulas
from rvmon.language.checked import rewrite
from rvmon.language.checked.classify import is_end
from rvmon.language.checked.names_read import names_read
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.language.print import format_formula
from rvmon.texts import listed
from rvmon.trace.sample import Sample
from rvmon.trace.time import format_instant
from rvmon.verdicts.attempt import Attempt

if TYPE_CHECKING:
    from rvmon.analysis.truths import Plans


class PartTruth(Struct, frozen=True):
    """The truth of one subformula over a stretch of time."""

    depth: int  # its nesting depth; 0 for the trigger and the consequent
    text: str  # as in the specification
    part: str  # the part to which it belongs, `trigger` or `required`
    true: tuple[tuple[int, int], ...]  # closed intervals of ticks at which it is true
    # the positions at which it is false; elsewhere it is unknown
    false: tuple[tuple[int, int], ...]


class Breakdown(Struct, frozen=True):
    """An attempt explained by the truth of its subformulas."""

    attempt: Attempt
    start: int  # first tick shown
    end: int  # last tick shown
    # the instant (ticks) of a response after the deadline; `None` if there was none
    late: int | None
    # the trigger, then the consequent, each before its subformulas
    part_truths: tuple[PartTruth, ...]


AROUND = 0.15
"""The margin shown before the trigger and after the decision, relative to the time between them."""


def dissect(
    spec: CheckedSpec,
    samples: Sequence[Sample],
    end: int,
    attempt: Attempt,
    names: frozenset[str] | None = None,
) -> Breakdown:
    """Break down an attempt on a recording that ends at `end` (ticks).

    Source: SEMANTICS 2; Kleene's value by a pessimistic and an optimistic reading (SEMANTICS 1).
    """
    requirement = spec.requirements[attempt.requirement]
    last = end if attempt.decided is None else attempt.decided
    length = last - attempt.triggered
    margin = max(int(length * AROUND), 2) if length else small_step(spec, [requirement])
    first = samples[0].t
    start, stop = max(attempt.triggered - margin, first), min(last + margin, end)
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
    parts: list[tuple[str, formulas.Formula]] = [("required", requirement.consequent)]
    if not isinstance(requirement.trigger, formulas.BoundAtom | formulas.Constant):
        parts.insert(0, ("trigger", requirement.trigger))
    for part, whole in parts:
        for depth, formula in subformulas(whole, 0):
            truth = truths[id(formula)]
            spans = (within(one, start, stop).tolist() for one in (truth.true, truth.false))
            shown = [tuple((low, high) for low, high in one) for one in spans]
            part_truths.append(PartTruth(depth, format_formula(formula), part, *shown))
    return tuple(part_truths)


class _Part(Struct, frozen=True):
    """An operand of a trigger."""

    formula: formulas.Formula
    text: str  # the formula as text
    place: int  # its place among all operands of the trigger
    reads: frozenset[str]  # the signals that it reads


class _Miss(Struct, frozen=True):
    """The instant at which most operands of a conjunction were true."""

    there: tuple[_Part, ...]  # the operands that were true
    missing: tuple[_Part, ...]  # the operands that were not
    at: int | None  # the first such instant, ticks; `None` if no operand was ever true


def why_not_triggered(
    spec: CheckedSpec,
    requirement: Requirement,
    samples: Iterable[Sample],
    end: int,
    names: frozenset[str] | None = None,
) -> str:
    """One sentence on the operands that were missing when the trigger was nearest to being true.

    "" for triggers that are not explained: `end`, and those of `for each`.
    """
    trigger = TriggerParts(spec, requirement)
    return trigger.miss_in(look_through(spec, [trigger.question], samples, end, names))


class TriggerParts:
    """Splits a trigger into operands, to explain why it never came in a recording."""

    def __init__(self, spec: CheckedSpec, requirement: Requirement) -> None:
        options = [
            tuple(dict.fromkeys(rewrite.chain(part)))
            for part in dict.fromkeys(rewrite.chain(requirement.trigger, formulas.BinaryOp.OR))
            if requirement.for_each is None
        ]
        # asks for all operands; without any for `for each`, which is not explained
        self.question = Question(tuple(dict.fromkeys(chain(*options))))
        parts = {}
        operands = zip(self.question.formulas, self.question.texts, strict=True)
        for place, (formula, text) in enumerate(operands):
            reads = frozenset(spec.signals.keys() & {*names_read(formula)})
            parts[formula] = _Part(formula, text, place, reads)
        self._options = [tuple(parts[formula] for formula in option) for option in options]
        self._is_explained = requirement.for_each is None and not is_end(requirement.trigger)

    def miss_in(self, seen: RecordedTruths) -> str:
        """The sentence of `why_not_triggered`, from the truths of `question` over a recording."""
        if seen.first is None:
            return "the recording has no sample"
        if not self._is_explained:
            return ""
        truths = seen.truths(self.question)
        misses = [_miss(parts, truths) for parts in self._options]
        best = min(misses, key=lambda miss: len(miss.missing))
        if best.missing and best.at is None:
            return "; ".join(_apart(best.missing, truths, seen))
        return _sentence(best, truths, seen.first)


class Looking:
    """Caches what is needed to search recordings for subformulas of a specification."""

    def __init__(self, spec: CheckedSpec) -> None:
        self._spec = spec
        self._triggers: dict[str, TriggerParts] = {}
        self.plans: Plans = {}  # for `look_through`

    def trigger(self, requirement: str) -> TriggerParts:
        """The operands of the trigger of a requirement, given by its id."""
        if requirement not in self._triggers:
            owner = self._spec.requirements[requirement]
            self._triggers[requirement] = TriggerParts(self._spec, owner)
        return self._triggers[requirement]


def _miss(parts: tuple[_Part, ...], truths: Sequence[Truth]) -> _Miss:
    """The instant with the most true operands; ties go to more events, then to the first."""
    spans = [truths[part.place].true for part in parts]
    if not any(map(len, spans)):
        return _Miss((), parts, None)
    instants = distinct([one[:, 0] for one in spans])
    true = np.array([hold(one, instants) for one in spans])
    events = true[[isinstance(part.formula, formulas.EventAtom) for part in parts]].sum(axis=0)
    # The factor lets the number of true operands decide, and events only between equal numbers.
    best = int(np.argmax(true.sum(axis=0) * (len(parts) + 1) + events))
    is_there = true[:, best].tolist()
    there = tuple(part for part, is_true in zip(parts, is_there, strict=True) if is_true)
    missing = tuple(part for part, is_true in zip(parts, is_there, strict=True) if not is_true)
    return _Miss(there, missing, int(instants[best]))


def _sentence(miss: _Miss, truths: Sequence[Truth], origin: int) -> str:
    """The sentence for a trigger of which some operand was once true, or none is missing."""
    at = miss.at
    if at is None or not miss.missing:
        when = "" if at is None else f" at {format_instant(at, origin)}"
        return f"its trigger was true{when}, but not known to be false before: no edge was seen"
    rest = miss.there[0].formula
    for part in miss.there[1:]:
        rest = formulas.Binary(formulas.BinaryOp.AND, rest, part.formula)
    unknown = any(not hold(truths[part.place].false, at) for part in miss.missing)
    lacking = "was never known to be true" if unknown else "was never true"
    while_ = f"while `{format_formula(rest)}` was (first at {format_instant(at, origin)})"
    return f"{_either(miss.missing)} {lacking} {while_}"


def _apart(
    parts: tuple[_Part, ...], truths: Sequence[Truth], seen: RecordedTruths
) -> Iterator[str]:
    """The clauses for a trigger of which no operand was ever true."""
    valueless = _without_values(parts, seen)
    groups: dict[str, list[_Part]] = {}
    for part in parts:
        word = "was never true"
        spans = truths[part.place].false.tolist()
        if isinstance(part.formula, formulas.SignalAtom) and part.formula.name in valueless:
            word = valueless[part.formula.name]
        elif not spans:
            word = "was never known"
        elif spans[0] != [seen.first, seen.end]:
            word = "was never known to be true"
        elif isinstance(part.formula, formulas.EventAtom):
            word = "never occurred"
        groups.setdefault(word, []).append(part)
    for word, alike in groups.items():
        yield f"{_either(alike)} {word}"
    signals = {part.formula.name for part in parts if isinstance(part.formula, formulas.SignalAtom)}
    for name in sorted(valueless.keys() - signals):
        yield f"`{name}` {valueless[name]}"


def _without_values(parts: Sequence[_Part], seen: RecordedTruths) -> Mapping[str, str]:
    """The signals that operands read and that never had a value, each with its clause."""
    if not seen.valueless:
        return {}
    lacking = {name for part in parts for name in part.reads} & seen.valueless
    absent = set() if seen.names is None else lacking - seen.names
    return dict.fromkeys(absent, "has no source") | dict.fromkeys(
        lacking - absent, "never had a value"
    )


def _either(parts: Sequence[_Part]) -> str:
    return listed([f"`{part.text}`" for part in parts], "or")
