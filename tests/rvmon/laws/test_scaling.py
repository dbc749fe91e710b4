"""The length of a tick is of no account to an automaton: it steps from event to event."""

from __future__ import annotations

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rvmon.errors import RvmonError
from rvmon.session import Spec
from rvmon.spec.checked import Formula, UpdateFunction, UpdateValue
from rvmon.testing.case import Case
from rvmon.testing.drive import drive
from rvmon.testing.generate_spec import Profile
from rvmon.testing.scale import compact, in_units, scaled
from rvmon.testing.strategies import cases
from rvmon.testing.walk import numerics
from rvmon.verdict.report import Report

SPARSE = 1_000
"""So many ticks between any two instants that differ: one tick more never meets another."""

FURTHER = 1_000_000


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


@settings(max_examples=80, deadline=None)
@given(data=st.data())
def test_a_case_made_compact_is_judged_the_same(data: st.DataObject) -> None:
    """Brought to few ticks, a case has the same attempts, at the same instants and ticks."""
    case = scaled(data.draw(cases(Profile(mixed=False, requirements=1))), SPARSE)
    small = compact(case)
    assume(small is not None)
    assert small is not None
    assert small.unit <= small.grain
    wanted = in_units(by_automaton(case), small.grain, small.origin)
    assert in_units(by_automaton(small.case), small.unit) == wanted
