"""The length of a tick is of no account: what is judged goes from event to event."""

from dataclasses import replace

import pytest
from hypothesis import assume, given
from msgspec import structs
from tests.rvmon.laws.tried import TRIED, judge
from tests.tools.build import scaled

from rvmon.language.checked import formula as rv
from rvmon.language.checked.formula import Formula, UpdateFunction, UpdateValue
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.syntax import numerics
from rvmon.testing.strategies import cases
from rvmon.trace.sample import Sample
from rvmon.verdicts.report import Report

SPARSE = 1_000
"""So many ticks between any two instants that differ: one tick more never meets another."""

FURTHER = 1_000_000


@pytest.mark.law
@TRIED
@given(cases(Profile(mixed=False, requirements=1)))
def test_scaling(case: Case) -> None:
    parts = [part for r in case.spec.requirements.values() for part in _numbers(r.trigger)]
    parts += [part for r in case.spec.requirements.values() for part in _numbers(r.consequent)]
    parts += [
        part.function
        for r in case.spec.requirements.values()
        for capture in r.captures
        for part in rv.numbers_in(capture.value)
        if isinstance(part, UpdateValue)
    ]
    assume(UpdateFunction.RATE not in parts)  # it is per second
    short = judge(longer(case, SPARSE))
    long = judge(longer(case, SPARSE * FURTHER))
    assert in_units(long, SPARSE * FURTHER) == in_units(short, SPARSE)


def _numbers(formula: Formula) -> list[UpdateFunction]:
    return [part.function for part in numerics(formula) if isinstance(part, UpdateValue)]


def longer(case: Case, factor: int) -> Case:
    spec = case.spec
    signals = {
        name: structs.replace(one, stale_after=one.stale_after and one.stale_after * factor)
        for name, one in spec.signals.items()
    }
    requirements = {
        name: replace(
            one, trigger=scaled(one.trigger, factor), consequent=scaled(one.consequent, factor)
        )
        for name, one in spec.requirements.items()
    }
    period = spec.period and spec.period * factor
    actions = tuple(
        replace(one, t=one.t * factor) if isinstance(one, Sample) else one * factor
        for one in case.actions
    )
    return replace(
        case,
        spec=structs.replace(spec, period=period, signals=signals, requirements=requirements),
        actions=actions,
        end=case.end and case.end * factor,
    )


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
