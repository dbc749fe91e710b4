"""Why a requirement was never triggered: how near its trigger came."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rvmon.explain.spans import holds
from rvmon.explain.states import values_read
from rvmon.explain.truths import Truth, truths_of
from rvmon.plan.graph import Graph
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    EventAtom,
    Formula,
    SignalAtom,
)
from rvmon.spec.checked.reads import names_read
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.spec.print.printer import format_formula
from rvmon.trace.gaps import is_unknown
from rvmon.trace.sample import Sample
from rvmon.trace.time import format_ticks


@dataclass(frozen=True, slots=True)
class _Miss:
    """The moment at which most parts of a conjunction were true.

    Attributes:
        parts: of the conjunction.
        there: those that were true.
        at: the first such instant; `None` if no part was ever true.
    """

    parts: tuple[Formula, ...]
    there: tuple[Formula, ...]
    at: int | None

    @property
    def missing(self) -> tuple[Formula, ...]:
        """The parts that were not true."""
        return tuple(part for part in self.parts if part not in self.there)


def why_not_triggered(
    spec: CheckedSpec,
    requirement: Requirement,
    samples: Sequence[Sample],
    end: int,
    names: frozenset[str] | None = None,
) -> str:
    """One sentence: what its trigger lacked when it was nearest; empty if there is none to say.

    Args:
        spec: the specification.
        requirement: one that was not triggered.
        samples: the recording, in order.
        end: its last instant, ticks.
        names: the signals and events that have a source; `None`: all.
    """
    trigger = requirement.trigger
    if not samples:
        return "the recording has no sample"
    if requirement.for_each is not None or trigger == BoundAtom(Bound.END):
        return ""
    options = [_flat(part, BinaryOp.AND) for part in _flat(trigger, BinaryOp.OR)]
    asked = list(dict.fromkeys(part for option in options for part in option))
    seen = dict(zip(asked, truths_of(spec, asked, samples, end, names), strict=True))
    misses = [_miss(parts, seen) for parts in options]
    best = min(misses, key=lambda miss: len(miss.missing))
    if best.missing and best.at is None:
        unborn = _unborn(spec, best.parts, samples, names)
        return "; ".join(_apart(best.parts, seen, unborn, samples[0].t, end))
    return _sentence(best, seen)


def read_as_values(spec: CheckedSpec, requirement: Requirement) -> Graph | None:
    """The parts of a trigger, if the values of what they read are all that counts.

    Returns:
        `None` if updates that repeat a value, payloads or positions may make a difference.
    """
    options = _flat(requirement.trigger, BinaryOp.OR)
    parts = [part for option in options for part in _flat(option, BinaryOp.AND)]
    return values_read(spec, requirement, [part for part in parts if part != BoundAtom(Bound.END)])


def _flat(formula: Formula, op: BinaryOp) -> tuple[Formula, ...]:
    match formula:
        case Binary(op=found, left=left, right=right) if found is op:
            return tuple(dict.fromkeys((*_flat(left, op), *_flat(right, op))))
        case _:
            return (formula,)


def _miss(parts: tuple[Formula, ...], seen: Mapping[Formula, Truth]) -> _Miss:
    """The moment at which most parts were true; of equals one with more events, then the first."""
    best: tuple[tuple[int, int, int], tuple[Formula, ...]] = ((0, 0, 0), ())
    for at in sorted({low for part in parts for low, _ in seen[part].sure}):
        there = tuple(part for part in parts if holds(seen[part].sure, at))
        events = sum(isinstance(part, EventAtom) for part in there)
        best = max(best, ((len(there), events, -at), there), key=lambda found: found[0])
    (_, _, at), there = best
    return _Miss(parts, there, -at if there else None)


def _sentence(miss: _Miss, seen: Mapping[Formula, Truth]) -> str:
    """What is to be reported if some part was true, or there is none."""
    at = miss.at
    if at is None or not miss.missing:
        when = "" if at is None else f" at {format_ticks(at)}"
        return f"its trigger was true{when}, but not known to be false before: no edge was seen"
    rest = miss.there[0]
    for part in miss.there[1:]:
        rest = Binary(BinaryOp.AND, rest, part)
    unknown = any(holds(seen[part].may, at) for part in miss.missing)
    lacking = "was never known to be true" if unknown else "was never true"
    while_ = f"while `{format_formula(rest)}` was (first at {format_ticks(at)})"
    return f"{_listed(miss.missing)} {lacking} {while_}"


def _apart(
    parts: tuple[Formula, ...],
    seen: Mapping[Formula, Truth],
    unborn: Mapping[str, str],
    start: int,
    end: int,
) -> Iterator[str]:
    """What is reported of parts of which none was ever true, and of signals without a value."""
    groups: dict[str, list[Formula]] = {}
    for part in parts:
        word = "was never true"
        low, high = seen[part].may[0]
        if isinstance(part, SignalAtom) and part.name in unborn:
            word = unborn[part.name]
        elif low <= start and high >= end:
            word = "was never known"
        elif low <= end:
            word = "was never known to be true"
        elif isinstance(part, EventAtom):
            word = "never occurred"
        groups.setdefault(word, []).append(part)
    for word, own in groups.items():
        yield f"{_listed(own)} {word}"
    signals = {part.name for part in parts if isinstance(part, SignalAtom)}
    for name in sorted(unborn.keys() - signals):
        yield f"`{name}` {unborn[name]}"


def _unborn(
    spec: CheckedSpec,
    parts: Sequence[Formula],
    samples: Sequence[Sample],
    sources: frozenset[str] | None,
) -> Mapping[str, str]:
    """Of the signals that parts read, those without any value, and what is reported of them."""
    lacking = {name for part in parts for name in names_read(part)} & spec.signals.keys()
    absent = set() if sources is None else lacking - sources
    lacking -= absent
    for sample in samples:
        if not lacking:
            break
        lacking -= {name for name in lacking if not is_unknown(sample.values.get(name))}
    return dict.fromkeys(absent, "has no source") | dict.fromkeys(lacking, "never had a value")


def _listed(parts: Sequence[Formula]) -> str:
    texts = [f"`{format_formula(part)}`" for part in parts]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} or {texts[-1]}"
