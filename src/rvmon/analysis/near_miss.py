"""Why a requirement was never triggered: how near its trigger came."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from rvmon.analysis.spans import distinct, hold
from rvmon.analysis.truths import Question, Seen, Truth, look_through
from rvmon.spec.checked.classify import is_end
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    EventAtom,
    Formula,
    SignalAtom,
)
from rvmon.spec.checked.names_read import names_read
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.spec.print import format_formula
from rvmon.texts import listed
from rvmon.trace.sample import Sample
from rvmon.trace.time import format_instant


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


def miss_in(spec: CheckedSpec, requirement: Requirement, seen: Seen) -> str:
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


def _without_values(spec: CheckedSpec, parts: Sequence[Formula], seen: Seen) -> Mapping[str, str]:
    """The signals without any value that the operands read, each with the clause for it."""
    read = {name for part in parts for name in names_read(part)} & spec.signals.keys()
    lacking = read & seen.valueless
    absent = set() if seen.names is None else lacking - seen.names
    return dict.fromkeys(absent, "has no source") | dict.fromkeys(
        lacking - absent, "never had a value"
    )


def _either(parts: Sequence[Formula]) -> str:
    return listed([f"`{format_formula(part)}`" for part in parts], "or")
