"""Random test cases: a specification, and a trace biased towards its bounds and thresholds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rvmon.language.checked import specification
from rvmon.language.checked.formula import Interval, Literal
from rvmon.language.print import format_formula, format_numeric
from rvmon.testing.generate import Rng, chance, pick
from rvmon.testing.law.syntax import intervals, numerics
from rvmon.testing.law.word import Outage
from rvmon.trace.sample import Sample, Scalar, Value
from rvmon.trace.schema import Kind


@dataclass(frozen=True, slots=True)
class Case:
    """A case on which a monitor and the oracle are compared.

    Attributes:
        spec: the specification.
        actions: the calls of a monitor, in order: a sample, or the instant of an `advance`.
        end: the argument of `finish`, ticks.
        names: the names that have a source; `None`: all.
        outages: the outages, in any order.
    """

    spec: specification.CheckedSpec
    actions: tuple[Sample | int, ...]
    end: int | None = None
    names: frozenset[str] | None = None
    outages: tuple[Outage, ...] = ()

    @property
    def samples(self) -> tuple[Sample, ...]:
        """Only the samples."""
        return tuple(action for action in self.actions if isinstance(action, Sample))

    @property
    def advances(self) -> tuple[int, ...]:
        """Only the instants of `advance`, ticks."""
        return tuple(action for action in self.actions if isinstance(action, int))


def show_case(case: Case) -> str:
    """The specification as `.rv` text, then the calls of the monitor, one per line."""
    lines = [show_spec(case.spec), ""]
    if case.names is not None:
        lines.append(f"sources: {', '.join(sorted(case.names)) or 'none'}")
    for outage in case.outages:
        names = ", ".join(sorted(outage.names)) or "nothing"
        lines.append(f"outage  {outage.first:>4} to {outage.last}  of {names}")
    for action in case.actions:
        if isinstance(action, Sample):
            lines.append(f"sample  {action.t:>4}  {dict(action.values)}")
        else:
            lines.append(f"advance {action:>4}")
    lines.append(f"finish  {'' if case.end is None else case.end:>4}".rstrip())
    return "\n".join(lines)


def show_spec(spec: specification.CheckedSpec) -> str:
    """A checked specification as `.rv` text."""
    period = f" {spec.period} ns" if spec.time is specification.TimeModel.CLOCKED else ""
    lines = [f'spec {spec.name} "{spec.title}"', f"time {spec.time.value}{period}", ""]
    lines += [_signal(signal) for signal in spec.signals.values()]
    for event in spec.events.values():
        fields = ", ".join(f"{name}: {type_.kind.value}" for name, type_ in event.fields.items())
        lines.append(f"event {event.name}" + (f"({fields})" if fields else ""))
    for requirement in spec.requirements.values():
        lines += ["", *_requirement(requirement)]
    return "\n".join(lines)


def _signal(signal: specification.Signal) -> str:
    labels = f"{{{', '.join(signal.type.labels)}}}"
    type_ = labels if signal.type.kind is Kind.LABEL else signal.type.kind.value
    ignoring = " ignore NaN" if signal.ignores_nan else ""
    stale = "" if signal.stale_after is None else f" stale after {signal.stale_after} ns"
    return f"signal {signal.name} : {type_}{ignoring}{stale}"


def _requirement(requirement: specification.Requirement) -> Iterator[str]:
    yield f"requirement {requirement.id}"
    yield f"  {requirement.mode.value} {format_formula(requirement.trigger)}"
    yield f"  then {format_formula(requirement.consequent)}"
    if requirement.for_each:
        field = requirement.for_each.value
        yield f"  for each {requirement.for_each.name} in {field.event}.{field.field}"
    for capture in requirement.captures:
        yield f"  let {capture.name} = {format_numeric(capture.value)}"
    if requirement.at_end is not specification.EndPolicy.DEFAULT:
        yield f"  at end {requirement.at_end.value}"


@dataclass(frozen=True, slots=True)
class TraceProfile:
    """The limits of random traces.

    Attributes:
        samples: the greatest number of samples.
        fewest: the least number of samples, if the span allows it.
        span: roughly the ticks from the first to the last sample.
        long: the percentage of traces that may be three times as long, with signals that start
            later and are updated less often.
        sparse: the percentage of traces with some dozens of samples, of few names and partly far
            apart.
        unknowns: whether values may be `None` or NaN, and sources absent.
        advances: whether `advance` is called.
        outages: the percentage of traces with outages.
    """

    samples: int = 12
    fewest: int = 0
    span: int = 40
    long: int = 0
    sparse: int = 0
    unknowns: bool = True
    advances: bool = True
    outages: int = 0


def random_trace(rng: Rng, spec: specification.CheckedSpec, profile: TraceProfile) -> Case:
    """A random trace for a specification, with `advance`, `finish`, sources and outages.

    Gaps between samples are often a bound of the specification, or one tick longer. Numbers are the
    literals of the specification and their neighbours.

    Args:
        rng: `random.Random` with a seed, or one that draws from Hypothesis.
        spec: any specification; for the oracle, its bounds should be a few ticks.
        profile: the limits.
    """
    gaps = _gaps(spec)
    numbers = _numbers(spec)
    names = None
    if profile.unknowns and chance(rng, 8):
        names = frozenset(name for name in (*spec.signals, *spec.events) if not chance(rng, 20))
    # With sensors that fail often, earlier values matter, above all to instances that start later.
    often = 40 if any(requirement.for_each for requirement in spec.requirements.values()) else 25
    unknown = (30 if chance(rng, often) else 5) if profile.unknowns else 0
    longer = 3 if profile.long and chance(rng, profile.long) else 1
    sparse = bool(profile.sparse) and chance(rng, profile.sparse)
    longer = 4 if sparse else longer
    late = {n: rng.randint(1, 5 * longer) for n in spec.signals if chance(rng, 20 * longer)}
    values = _Values(spec, numbers, names, unknown, _several(spec), late, 35 // longer, sparse)
    time = start = pick(rng, (0, 1, 5, -3))
    actions: list[Sample | int] = []
    drawn = rng.randint(0 if chance(rng, 5) else 1, longer * profile.samples)
    for index in range(max(drawn, profile.fewest)):
        if index:
            gap = rng.randint(9, 30) if sparse and chance(rng, 8) else _gap(rng, gaps)
            if profile.advances and chance(rng, 15):
                actions.append(time + rng.randint(0, gap))
            time += gap
        if time - start > longer * profile.span:
            break
        actions.append(Sample(time, values.sample(rng, index)))
    if profile.advances and chance(rng, 25):
        time += _gap(rng, gaps)
        actions.append(time)
    end = time + _gap(rng, gaps) * rng.randint(0, 2) if chance(rng, 45) else None
    outages: tuple[Outage, ...] = ()
    if profile.outages and chance(rng, profile.outages):
        read = [action.t for action in actions if isinstance(action, Sample)] or [start]
        outages = tuple(_outage(rng, spec, read) for _ in range(rng.randint(1, 3)))
    return Case(spec, tuple(actions), end, names, outages)


def _outage(rng: Rng, spec: specification.CheckedSpec, read: Sequence[int]) -> Outage:
    """A random outage of some names for one or more ticks, often from or up to a sample.

    It may lie before or after all samples.
    """
    percent = pick(rng, (100, 50, 20))
    names = frozenset(n for n in (*spec.signals, *spec.events) if chance(rng, percent))
    first = rng.randint(read[0] - 3, read[-1] + 3)
    if chance(rng, 50):
        first = pick(rng, read)
    last = first + pick(rng, (0, 1, 2, 3, 5, 8))
    if chance(rng, 50):
        last = next((t for t in read if t >= last), last)
    return Outage(names, first, last)


def _gap(rng: Rng, gaps: Sequence[int]) -> int:
    return pick(rng, gaps) if chance(rng, 40) else rng.randint(1, 3)


def _gaps(spec: specification.CheckedSpec) -> list[int]:
    """One tick; and each bound and stale limit of the specification, exactly and one tick more."""
    gaps = {1}
    for window in _intervals(spec):
        for bound in (window.low, window.high):
            if bound is not None:
                gaps |= {bound, bound + 1}
    for signal in spec.signals.values():
        if signal.stale_after is not None:
            gaps |= {signal.stale_after, signal.stale_after + 1}
    return sorted(gap for gap in gaps if gap > 0)


def _intervals(spec: specification.CheckedSpec) -> list[Interval]:
    return [
        window
        for requirement in spec.requirements.values()
        for part in (requirement.trigger, requirement.consequent)
        for window in intervals(part)
    ]


def _numbers(spec: specification.CheckedSpec) -> list[int | float]:
    """The literals of all comparisons and their neighbours, and a few small numbers."""
    found: set[int | float] = {0, 1}
    for requirement in spec.requirements.values():
        for part in (requirement.trigger, requirement.consequent):
            for expression in numerics(part):
                if isinstance(expression, Literal) and not isinstance(expression.value, str):
                    found |= {expression.value - 1, expression.value, expression.value + 1}
    return sorted(found)


def _several(spec: specification.CheckedSpec) -> frozenset[str]:
    """The events that may occur more than once at an instant, if each requirement is `for each`."""
    found = [requirement.for_each for requirement in spec.requirements.values()]
    return frozenset() if None in found else frozenset(each.value.event for each in found if each)


@dataclass(frozen=True, slots=True)
class _Values:
    """Draws the values of samples, of which `unknown` per cent are unknown.

    A signal has no update, or only unknown ones, before the sample whose number `late` gives. From
    then on `often` per cent of the samples update it. In `sparse` traces events are rare.
    """

    spec: specification.CheckedSpec
    numbers: Sequence[int | float]
    names: frozenset[str] | None
    unknown: int
    several: frozenset[str]
    late: Mapping[str, int]
    often: int
    sparse: bool

    def sample(self, rng: Rng, index: int) -> dict[str, Value]:
        """Random updates; most signals have a value in the first sample that may update them."""
        values: dict[str, Value] = {}
        for name, signal in self.spec.signals.items():
            first = self.late.get(name, 0)
            if not self._has_source(name):
                continue
            if index < first:
                if self.unknown and chance(rng, 10):
                    values[name] = None
            elif chance(rng, 85 if index == first else self.often):
                values[name] = self._scalar(rng, signal.type)
        for name, event in self.spec.events.items():
            if self._has_source(name) and chance(rng, 8 if self.sparse else 30):
                values[name] = self._occurrence(rng, name, event.fields)
        return values

    def _has_source(self, name: str) -> bool:
        return self.names is None or name in self.names

    def _scalar(self, rng: Rng, type_: specification.Type) -> Scalar:
        if chance(rng, self.unknown):
            return float("nan") if type_.kind is Kind.REAL and chance(rng, 50) else None
        match type_.kind:
            case Kind.BOOL:
                return chance(rng, 50)
            case Kind.LABEL:
                return pick(rng, type_.labels)
            case Kind.INT:
                return min(max(int(pick(rng, self.numbers)), -(2**63)), 2**63 - 1)
            case Kind.REAL:
                value = pick(rng, self.numbers)
                if all(abs(number) < 2**53 for number in self.numbers):
                    return value
                return float(value) + pick(rng, (-0.5, 0.0, 0.5))  # beside whole numbers

    def _occurrence(self, rng: Rng, name: str, fields: Mapping[str, specification.Type]) -> Value:
        if chance(rng, self.unknown):
            return None
        if chance(rng, 5):
            return False
        if not fields or chance(rng, 5):
            return True
        payload = {name: self._scalar(rng, type_) for name, type_ in fields.items()}
        if name in self.several and chance(rng, 25):
            return (payload, {name: self._scalar(rng, t) for name, t in fields.items()})
        return payload
