"""What was lost, filled in: random cases that differ from one only in what it did not know."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from rvmon.spec.checked.specification import CheckedSpec, Event, Type
from rvmon.testing.case import Case
from rvmon.testing.generate.rng import Rng, chance, pick
from rvmon.trace.sample import Payload, Sample, Scalar, Value
from rvmon.trace.schema import Kind

_NUMBERS = (-2, -1, 0, 1, 2, 3)


def refilled(rng: Rng, case: Case) -> Case:
    """The case with a random value wherever one was lost.

    Signals keep their births: before its first known value nothing of a signal was lost. Where a
    signal became stale, updates may be put in, if nothing in the specification counts updates;
    events without a source may occur. NaN of a signal that ignores it is no update: nothing is lost
    there.

    Args:
        rng: draws the values.
        case: what is known.
    """
    lost = _Lost(rng, case.spec)
    actions: list[Sample | int] = []
    born: set[str] = set()
    updated: dict[str, int] = {}
    for action in case.actions:
        if isinstance(action, int):
            actions.append(action)
            continue
        values: dict[str, Value] = {}
        for name, value in action.values.items():
            if name in case.spec.ignoring and not _is_known(value):
                continue
            values[name] = lost.filled(name, value, born=name in born)
            if name in case.spec.signals:
                updated[name] = action.t
                if _is_known(value):
                    born.add(name)
        for name, event in case.spec.events.items():
            if case.names is not None and name not in case.names and chance(rng, 30):
                values[name] = lost.occurrence(event)
        for name, signal in case.spec.signals.items():
            is_stale = action.t > updated.get(name, action.t) + (signal.stale_after or 0)
            if signal.stale_after is not None and is_stale and name in born:
                values[name] = lost.scalar(signal.type)
        actions.append(Sample(action.t, values))
    names = None if case.names is None else case.names | case.spec.events.keys()
    return replace(case, actions=tuple(actions), names=names)


def _is_known(value: Value) -> bool:
    return value is not None and value == value


@dataclass(frozen=True, slots=True)
class _Lost:
    """Draws what was lost."""

    rng: Rng
    spec: CheckedSpec

    def filled(self, name: str, value: Value, *, born: bool) -> Value:
        if name in self.spec.signals:
            return (
                value if not born or _is_known(value) else self.scalar(self.spec.signals[name].type)
            )
        event = self.spec.events[name]
        if isinstance(value, tuple):
            return tuple(self._payload(event, one) for one in value)
        if value is None:
            return self.occurrence(event)
        if value is False or not event.fields:
            return value
        return self._payload(event, value if isinstance(value, Mapping) else {})

    def occurrence(self, event: Event) -> Value:
        if chance(self.rng, 50):
            return False
        return self._payload(event, {}) if event.fields else True

    def _payload(self, event: Event, payload: Payload) -> Payload:
        return {
            name: payload[name] if _is_known(payload.get(name)) else self.scalar(type_)
            for name, type_ in event.fields.items()
        }

    def scalar(self, type_: Type) -> Scalar:
        match type_.kind:
            case Kind.BOOL:
                return chance(self.rng, 50)
            case Kind.LABEL:
                return pick(self.rng, type_.labels)
            case Kind.INT | Kind.REAL:
                return pick(self.rng, _NUMBERS)
