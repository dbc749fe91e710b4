"""The length of a tick is of no account: what is judged goes from event to event."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from tests.tools.drive import drive
from tests.tools.forms import Maker
from tests.tools.scale import compact, in_units, scaled

from rvmon.spec.checked.formula import Formula, UpdateFunction, UpdateValue
from rvmon.testing.case import Case
from rvmon.testing.generate.spec import Profile
from rvmon.testing.law.syntax import numerics, parts_of
from rvmon.testing.strategies import cases
from rvmon.verdict.report import Report

SPARSE = 1_000
"""So many ticks between any two instants that differ: one tick more never meets another."""

FURTHER = 1_000_000


@pytest.mark.law
@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_scaling(data: st.DataObject) -> None:
    """A million times longer: the same attempts and verdicts, the same instants."""
    case = data.draw(cases(Profile(mixed=False, requirements=1)))
    parts = [part for r in case.spec.requirements.values() for part in _numbers(r.trigger)]
    parts += [part for r in case.spec.requirements.values() for part in _numbers(r.consequent)]
    parts += [
        part.function
        for r in case.spec.requirements.values()
        for capture in r.captures
        for part in parts_of(capture.value)
        if isinstance(part, UpdateValue)
    ]
    assume(UpdateFunction.RATE not in parts)  # it is per second
    short = judged(scaled(case, SPARSE))
    long = judged(scaled(case, SPARSE * FURTHER))
    assert in_units(long, SPARSE * FURTHER) == in_units(short, SPARSE)


def judged(case: Case) -> Report:
    """The report on a case."""
    return drive(Maker()(case), case)[0]


def _numbers(formula: Formula) -> list[UpdateFunction]:
    return [part.function for part in numerics(formula) if isinstance(part, UpdateValue)]


@pytest.mark.law
@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_a_case_made_compact_is_judged_the_same(data: st.DataObject) -> None:
    """Brought to few ticks, a case has the same attempts, at the same instants and ticks."""
    case = scaled(data.draw(cases(Profile(mixed=False, requirements=1))), SPARSE)
    small = compact(case)
    assume(small is not None)
    assert small is not None
    assert small.unit <= small.grain
    wanted = in_units(judged(case), small.grain, small.origin)
    assert in_units(judged(small.case), small.unit) == wanted
