"""The length of a tick is of no account to an engine: it steps from event to event."""

from __future__ import annotations

import sys
from types import FrameType

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from tests.tools.drive import drive
from tests.tools.forms import Maker
from tests.tools.scale import compact, in_units, scaled

from rvmon.spec.checked.formula import Formula, UpdateFunction, UpdateValue
from rvmon.testing.case import Case
from rvmon.testing.generate.spec import Profile
from rvmon.testing.law.walk import numerics, parts_of
from rvmon.testing.strategies import cases
from rvmon.verdict.report import Report

SPARSE = 1_000
"""So many ticks between any two instants that differ: one tick more never meets another."""

FURTHER = 1_000_000

FORMS = ("auto", "automaton", "network", "c")
"""Progression may have to step at every tick; of the core, no steps are counted."""

ENGINE = ("runtime/table_machine.py", "/dataflow/", "/runtime/", "<generated")
"""The code whose calls are the steps of an engine."""


@pytest.mark.law
@pytest.mark.parametrize("form", FORMS)
@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_scaling(form: str, data: st.DataObject) -> None:
    """A million times longer: the same attempts and verdicts, as many steps, the same instants."""
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
    short, steps = judged(form, scaled(case, SPARSE))
    long, more_steps = judged(form, scaled(case, SPARSE * FURTHER))
    assert in_units(long, SPARSE * FURTHER) == in_units(short, SPARSE)
    assert more_steps == steps


def judged(form: str, case: Case) -> tuple[Report, int]:
    """A form's report and its steps; formulas that it refuses are passed over."""
    monitor = Maker(form)(case)
    assume(monitor is not None)
    assert monitor is not None
    steps = 0

    def count(frame: FrameType, event: str, _: object) -> None:
        nonlocal steps
        steps += event == "call" and any(one in frame.f_code.co_filename for one in ENGINE)

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        report, _ = drive(monitor, case)
    finally:
        sys.setprofile(before)
    return report, steps


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
    wanted = in_units(judged("automaton", case)[0], small.grain, small.origin)
    assert in_units(judged("automaton", small.case)[0], small.unit) == wanted
