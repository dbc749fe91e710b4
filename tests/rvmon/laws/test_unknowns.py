"""Knowing more never overturns what was decided while knowing less."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from hypothesis import assume
from hypothesis import strategies as st
from tests.tools.build import start
from tests.tools.compare import outcomes

from rvmon.spec.checked.formula import Probe, ProbeAtom
from rvmon.spec.checked.specification import CheckedSpec, EndPolicy, Event, Mode, Type
from rvmon.testing.law.syntax import subformulas
from rvmon.testing.strategies import specs, traces
from rvmon.trace.sample import Payload, Sample, Scalar, Value
from rvmon.trace.schema import Kind
from rvmon.verdict.attempt import Decision


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
        return draw(scalars(type_)) if value is None or value != value else value

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


def _is_known(sample: Sample, name: str) -> bool:
    value = sample.values.get(name)
    return value is not None and value == value


def test_resolving_unknowns(subject: Any, holds: Any) -> None:
    """With values for what was unknown, P stays P and F stays F, decided no later.

    The trigger is known (`start`), `known(x)` speaks of the unknown itself and is left out.
    """

    @holds
    def _(data: st.DataObject) -> None:
        spec = data.draw(specs(subject.one))
        [first] = spec.requirements.values()
        probes = [part for part in subformulas(first.consequent) if isinstance(part, ProbeAtom)]
        assume(not any(part.probe is Probe.KNOWN for part in probes))
        assume(first.at_end not in (EndPolicy.PASS, EndPolicy.FAIL))
        required = replace(first, trigger=start, mode=Mode.UPON, pulse=False)
        spec = replace(spec, requirements={required.id: required})
        case = data.draw(traces(spec))
        # What is not there yet is not what was lost: it stays so.
        names = {*spec.signals}
        first = {n: next((s.t for s in case.samples if _is_known(s, n)), None) for n in names}
        assume(all(t == case.samples[0].t for t in first.values() if case.samples))
        told = tuple(
            resolved(spec, action, data.draw) if isinstance(action, Sample) else action
            for action in case.actions
        )
        before = outcomes(subject.judge(case))
        after = outcomes(subject.judge(replace(case, actions=told)))
        assert set(before) == set(after)
        for key, outcome in before.items():
            if outcome.decided is not None:
                assert after[key].verdict == outcome.verdict
                assert after[key].decided is not None
                assert after[key].decided <= outcome.decided
                if outcome.decision is Decision.PREFIX:
                    assert after[key].decision is Decision.PREFIX
