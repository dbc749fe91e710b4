"""A specification with a trace to judge, as test data, and as text to try by hand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rvmon.spec.checked.specification import CheckedSpec, EndPolicy, Requirement, Signal, TimeModel
from rvmon.spec.print.printer import format_formula, format_numeric
from rvmon.testing.law.outage import Outage
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind


@dataclass(frozen=True, slots=True)
class Case:
    """One thing to compare a monitor and the law on.

    Attributes:
        spec: what to judge by.
        actions: what a monitor is given, in order: a sample, or the instant of an `advance`.
        end: what it is given by `finish`, ticks.
        names: the names that have a source; `None`: all.
        outages: what was lost, in any order; no monitor can be told yet.
    """

    spec: CheckedSpec
    actions: tuple[Sample | int, ...]
    end: int | None = None
    names: frozenset[str] | None = None
    outages: tuple[Outage, ...] = ()

    @property
    def samples(self) -> tuple[Sample, ...]:
        """The samples alone."""
        return tuple(action for action in self.actions if isinstance(action, Sample))

    @property
    def advances(self) -> tuple[int, ...]:
        """The instants of `advance` alone."""
        return tuple(action for action in self.actions if isinstance(action, int))


def show_case(case: Case) -> str:
    """The specification as `.rv` text, then what the monitor is given, line by line."""
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


def show_spec(spec: CheckedSpec) -> str:
    """A checked specification as `.rv` text."""
    period = f" {spec.period} ns" if spec.time is TimeModel.CLOCKED else ""
    lines = [f'spec {spec.name} "{spec.title}"', f"time {spec.time.value}{period}", ""]
    lines += [_signal(signal) for signal in spec.signals.values()]
    for event in spec.events.values():
        fields = ", ".join(f"{name}: {type_.kind.value}" for name, type_ in event.fields.items())
        lines.append(f"event {event.name}" + (f"({fields})" if fields else ""))
    for requirement in spec.requirements.values():
        lines += ["", *_requirement(requirement)]
    return "\n".join(lines)


def _signal(signal: Signal) -> str:
    labels = f"{{{', '.join(signal.type.labels)}}}"
    type_ = labels if signal.type.kind is Kind.LABEL else signal.type.kind.value
    ignoring = " ignore NaN" if signal.ignores_nan else ""
    stale = "" if signal.stale_after is None else f" stale after {signal.stale_after} ns"
    return f"signal {signal.name} : {type_}{ignoring}{stale}"


def _requirement(requirement: Requirement) -> Iterator[str]:
    yield f"requirement {requirement.id}"
    yield f"  {requirement.mode.value} {format_formula(requirement.trigger)}"
    yield f"  then {format_formula(requirement.consequent)}"
    if requirement.for_each:
        field = requirement.for_each.value
        yield f"  for each {requirement.for_each.name} in {field.event}.{field.field}"
    for capture in requirement.captures:
        yield f"  let {capture.name} = {format_numeric(capture.value)}"
    if requirement.at_end is not EndPolicy.DEFAULT:
        yield f"  at end {requirement.at_end.value}"
