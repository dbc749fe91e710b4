"""Knowing more never overturns what was decided while knowing less."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.rvmon.laws.tried import ONE, TRIED, is_known, judge, known_from_the_first
from tests.tools.build import start
from tests.tools.compare import outcomes

from rvmon.spec.checked.formula import Probe, ProbeAtom
from rvmon.spec.checked.specification import CheckedSpec, EndPolicy, Event, Mode, Type
from rvmon.testing.law.syntax import subformulas
from rvmon.testing.strategies import specs, traces
from rvmon.trace.sample import Payload, Sample, Scalar, Value
from rvmon.trace.schema import Kind
from rvmon.verdict.attempt import Decision

pytestmark = pytest.mark.law


def scalars(type_: Type) -> st.SearchStrategy[Scalar]:
    match type_.kind:
        case Kind.BOOL:
            return st.booleans()
        case Kind.LABEL:
            return st.sampled_from(type_.labels)
        case _:
            return st.integers(-2, 3)


def resolved(spec: CheckedSpec, sample: Sample, draw: Callable[..., Scalar]) -> Sample:
    """The sample with a value wherever it said `None` or NaN, or left a field out."""

    def scalar(value: Scalar, type_: Type) -> Scalar:
        return value if is_known(value) else draw(scalars(type_))

    def occurrence(value: Value, event: Event) -> Value:
        if value is None:
            value = bool(draw(st.booleans()))
        if value is True and event.fields:
            value = {}
        if not isinstance(value, Mapping):
            return value
        payload: Payload = value
        return {name: scalar(payload.get(name), type_) for name, type_ in event.fields.items()}

    def of(name: str, value: Value) -> Value:
        if name in spec.events:
            return occurrence(value, spec.events[name])
        assert value is None or isinstance(value, bool | int | float | str)
        return scalar(value, spec.signals[name].type)

    return Sample(sample.t, {name: of(name, value) for name, value in sample.values.items()})


@TRIED
@given(specs(ONE), st.data())
def test_resolving_unknowns(spec: CheckedSpec, data: st.DataObject) -> None:
    """With values for what was unknown, P stays P and F stays F, decided no later.

    The trigger is known (`start`), `known(x)` speaks of the unknown itself and is left out. What is
    not there yet is not what was lost: here all is there from the first sample on.
    """
    [first] = spec.requirements.values()
    probes = [part for part in subformulas(first.consequent) if isinstance(part, ProbeAtom)]
    assume(not any(part.probe is Probe.KNOWN for part in probes))
    assume(first.at_end not in (EndPolicy.PASS, EndPolicy.FAIL))
    required = replace(first, trigger=start, mode=Mode.UPON, pulse=False)
    spec = replace(spec, requirements={required.id: required})
    case = known_from_the_first(data.draw(traces(spec)))
    told = tuple(
        resolved(spec, action, data.draw) if isinstance(action, Sample) else action
        for action in case.actions
    )
    before = outcomes(judge(case))
    after = outcomes(judge(replace(case, actions=told)))
    assert set(before) == set(after)
    for key, outcome in before.items():
        if outcome.decided is not None:
            assert after[key].verdict == outcome.verdict
            assert after[key].decided is not None
            assert after[key].decided <= outcome.decided
            if outcome.decision is Decision.PREFIX:
                assert after[key].decision is Decision.PREFIX
