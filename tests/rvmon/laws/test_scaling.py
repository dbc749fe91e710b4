"""The length of a tick is of no account to an automaton: it steps from event to event."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rvmon.errors import RvmonError
from rvmon.session import Spec
from rvmon.spec.checked import (
    Binary,
    CheckedSpec,
    Formula,
    Interval,
    Unary,
    UpdateFunction,
    UpdateValue,
)
from rvmon.testing.case import Case
from rvmon.testing.drive import drive
from rvmon.testing.generate_spec import Profile
from rvmon.testing.strategies import cases
from rvmon.testing.walk import numerics
from rvmon.trace.sample import Sample
from rvmon.verdict.report import Report

SPARSE = 1_000
"""So many ticks between any two instants that differ: one tick more never meets another."""

FURTHER = 1_000_000


def scaled(case: Case, factor: int) -> Case:
    """All durations and stamps, so many times longer."""
    return Case(
        _spec(case.spec, factor),
        tuple(
            replace(action, t=action.t * factor) if isinstance(action, Sample) else action * factor
            for action in case.actions
        ),
        None if case.end is None else case.end * factor,
        case.names,
    )


def _spec(spec: CheckedSpec, factor: int) -> CheckedSpec:
    return replace(
        spec,
        period=None if spec.period is None else spec.period * factor,
        signals={
            name: signal
            if signal.stale_after is None
            else replace(signal, stale_after=signal.stale_after * factor)
            for name, signal in spec.signals.items()
        },
        requirements={
            name: replace(
                owed,
                trigger=_formula(owed.trigger, factor),
                consequent=_formula(owed.consequent, factor),
            )
            for name, owed in spec.requirements.items()
        },
    )


def _formula(formula: Formula, factor: int) -> Formula:
    match formula:
        case Unary(operand=operand, interval=window):
            operand = _formula(operand, factor)
            return replace(formula, operand=operand, interval=_window(window, factor))
        case Binary(left=left, right=right, interval=window):
            left, right = _formula(left, factor), _formula(right, factor)
            return replace(formula, left=left, right=right, interval=_window(window, factor))
        case _:
            return formula


def _window(window: Interval | None, factor: int) -> Interval | None:
    if window is None:
        return None
    return Interval(window.low * factor, None if window.high is None else window.high * factor)


def in_units(report: Report, unit: int) -> list[tuple[object, ...]]:
    """The attempts with each instant as whole units and the ticks beside them."""

    def split(instant: int | None) -> tuple[int, int] | None:
        if instant is None:
            return None
        whole = (instant + unit // 2) // unit
        return whole, instant - whole * unit

    return [
        (a.requirement, a.number, split(a.triggered), split(a.decided), a.verdict, a.decision)
        for a in report.attempts
    ]


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_scaling(data: st.DataObject) -> None:
    """A million times longer: the same attempts and verdicts, at the same instants and ticks."""
    case = data.draw(cases(Profile(mixed=False, requirements=1)))
    parts = [part for r in case.spec.requirements.values() for part in _numbers(r.trigger)]
    parts += [part for r in case.spec.requirements.values() for part in _numbers(r.consequent)]
    assume(UpdateFunction.RATE not in parts)  # it is per second
    short, long = scaled(case, SPARSE), scaled(case, SPARSE * FURTHER)
    wanted = in_units(by_automaton(short), SPARSE)
    assert in_units(by_automaton(long), SPARSE * FURTHER) == wanted


def by_automaton(case: Case) -> Report:
    """The automaton's report; formulas that have none are passed over."""
    try:
        monitor = Spec(case.spec).monitor(engine="automaton", sources=case.names)
    except RvmonError as error:
        assume("no automaton" not in str(error))
        raise
    return drive(monitor, case)[0]


def _numbers(formula: Formula) -> list[UpdateFunction]:
    return [part.function for part in numerics(formula) if isinstance(part, UpdateValue)]
