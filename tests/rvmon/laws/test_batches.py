"""Samples that come in pieces, or out of order, are judged as if they had come whole, in order."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import structs
from tests.rvmon.laws.tried import judge
from tests.tools.compare import differences

from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.strategies import cases
from rvmon.trace.sample import Sample

DELAY = 9


@pytest.mark.law
@settings(max_examples=12, deadline=None)
@given(data=st.data())
def test_the_order_inside_a_batch(data: st.DataObject) -> None:
    """A sample in pieces with equal stamps, in any order, is the same as the whole sample."""
    case = data.draw(cases(Profile(mixed=False)))
    expected = judge(case)
    monitor = Spec(case.spec).monitor(settle="next", sources=case.names)
    for action in case.actions:
        if not isinstance(action, Sample):
            monitor.advance_ns(action)
            continue
        pieces = data.draw(st.permutations([{name: x} for name, x in action.values.items()]))
        for piece in pieces or [{}]:
            monitor.step_ns(action.t, piece)
    report = monitor.finish_ns(case.end)
    assert differences(expected, report) == []
    assert report.health == expected.health


@pytest.mark.law
@settings(max_examples=12, deadline=None)
@given(data=st.data())
def test_the_order_within_the_delay(data: st.DataObject) -> None:
    """Samples that come late, but within `max delay`, are judged at their instants."""
    case = data.draw(cases(Profile(mixed=False)))
    case = replace(case, actions=case.samples)
    late = [(s.t + data.draw(st.integers(0, DELAY)), s) for s in case.samples]
    spec = structs.replace(case.spec, max_delay=DELAY)
    monitor = Spec(spec).monitor(sources=case.names)
    told = [sample for _, sample in sorted(late, key=lambda entry: entry[0])]
    for sample in told:
        monitor.step_ns(sample.t, sample.values)
    report = monitor.finish_ns(case.end)
    expected = judge(case)
    assert differences(expected, report) == []
    assert report.health == expected.health
    pairs = [(sample.t * 1e-9, sample.values) for sample in told]
    end = None if case.end is None else case.end * 1e-9
    found = Spec(spec).evaluate(pairs, sources=case.names, until=end)
    assert differences(expected, found) == []
