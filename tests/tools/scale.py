"""Cases with other units of time: all durations and stamps multiplied, or brought to few ticks.

Source: SEMANTICS 7, the law of scaling.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import gcd

from rvmon.spec.checked.formula import Binary, Formula, Interval, Unary, UpdateFunction, UpdateValue
from rvmon.spec.checked.specification import CheckedSpec, TimeModel
from rvmon.testing.case import Case
from rvmon.testing.law.syntax import intervals, numerics, subformulas
from rvmon.trace.sample import Sample
from rvmon.verdict.report import Report


def scaled(case: Case, factor: int) -> Case:
    """All durations and stamps, so many times longer."""
    return _timed(case, lambda duration: duration * factor, lambda t: t * factor)


@dataclass(frozen=True, slots=True)
class Compact:
    """A case with the same order of events within few ticks.

    Attributes:
        case: the new one.
        unit: its ticks that stand for `grain` of the old one.
        grain: what all durations and distances of the old one are multiples of, ticks.
        origin: the instant of the old one that became 0.
    """

    case: Case
    unit: int
    grain: int
    origin: int


def compact(case: Case) -> Compact | None:
    """A case as short as the law of scaling allows; `None` if it speaks of absolute durations.

    Single ticks stay what they are: between any two instants so many are left that one tick more,
    as often as operators nest, never meets another.
    """
    formulas = [
        formula
        for requirement in case.spec.requirements.values()
        for formula in (requirement.trigger, requirement.consequent)
    ]
    rates = (
        part.function is UpdateFunction.RATE
        for formula in formulas
        for part in numerics(formula)
        if isinstance(part, UpdateValue)
    )
    if not case.samples or any(rates) or case.spec.max_delay is not None:
        return None
    period = case.spec.period if case.spec.time is TimeModel.CLOCKED else None
    first = case.samples[0].t
    origin = first - first % period if period else first
    grain = gcd(*_durations(case, formulas), *(t - origin for t in _instants(case)))
    if not grain:
        return None
    unit = 4 + 2 * sum(1 for formula in formulas for _ in subformulas(formula))
    if grain <= unit:
        unit = grain
    small = _timed(
        case, lambda duration: duration // grain * unit, lambda t: (t - origin) // grain * unit
    )
    return Compact(small, unit, grain, origin)


def in_units(report: Report, unit: int, origin: int = 0) -> list[tuple[object, ...]]:
    """The attempts with each instant as whole units and the ticks beside them."""

    def split(instant: int | None) -> tuple[int, int] | None:
        if instant is None:
            return None
        whole = (instant - origin + unit // 2) // unit
        return whole, instant - origin - whole * unit

    return [
        (a.requirement, a.number, split(a.triggered), split(a.decided), a.verdict, a.decision)
        for a in report.attempts
    ]


def _durations(case: Case, formulas: list[Formula]) -> Iterator[int]:
    for formula in formulas:
        for window in intervals(formula):
            yield window.low
            if window.high is not None:
                yield window.high
    for signal in case.spec.signals.values():
        yield signal.stale_after or 0
    yield case.spec.period or 0


def _instants(case: Case) -> Iterator[int]:
    for action in case.actions:
        yield action.t if isinstance(action, Sample) else action
    if case.end is not None:
        yield case.end
    for outage in case.outages:
        yield from (outage.first, outage.last)


def _timed(case: Case, longer: Callable[[int], int], later: Callable[[int], int]) -> Case:
    return Case(
        _spec(case.spec, longer),
        tuple(
            replace(action, t=later(action.t)) if isinstance(action, Sample) else later(action)
            for action in case.actions
        ),
        None if case.end is None else later(case.end),
        case.names,
        tuple(replace(o, first=later(o.first), last=later(o.last)) for o in case.outages),
    )


def _spec(spec: CheckedSpec, longer: Callable[[int], int]) -> CheckedSpec:
    return replace(
        spec,
        period=None if spec.period is None else longer(spec.period),
        signals={
            name: signal
            if signal.stale_after is None
            else replace(signal, stale_after=longer(signal.stale_after))
            for name, signal in spec.signals.items()
        },
        requirements={
            name: replace(
                owed,
                trigger=retimed(owed.trigger, longer),
                consequent=retimed(owed.consequent, longer),
            )
            for name, owed in spec.requirements.items()
        },
    )


def retimed(formula: Formula, longer: Callable[[int], int]) -> Formula:
    """A formula with other bounds."""
    match formula:
        case Unary(operand=operand, interval=window):
            operand = retimed(operand, longer)
            return replace(formula, operand=operand, interval=_window(window, longer))
        case Binary(left=left, right=right, interval=window):
            left, right = retimed(left, longer), retimed(right, longer)
            return replace(formula, left=left, right=right, interval=_window(window, longer))
        case _:
            return formula


def _window(window: Interval | None, longer: Callable[[int], int]) -> Interval | None:
    if window is None:
        return None
    return Interval(longer(window.low), None if window.high is None else longer(window.high))
