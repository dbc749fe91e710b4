"""Samples that arrive out of order are evaluated as if they had arrived in order."""

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

DELAY = 9


@pytest.mark.law
@settings(max_examples=12, deadline=None)
@given(data=st.data())
def test_samples_late_within_the_delay_are_put_in_order(data: st.DataObject) -> None:
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
