"""`for each x in e.f`: what an instance sees of its event, and which values occur."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.dataflow.inputs import Reported, payloads_of
from rvmon.spec.checked import FieldValue
from rvmon.trace.sample import Payload, Scalar, Value


def values_in(source: FieldValue, values: Mapping[str, Value]) -> list[Scalar]:
    """The known values of the field in a sample, in order."""
    found: list[Scalar] = []
    for payload in payloads_of(values.get(source.event, False)):
        value = None if payload is None else _known(payload, source.field)
        if value is not None:
            found.append(value)
    return found


def seen_by(source: FieldValue, own: Scalar, values: Mapping[str, Value]) -> Mapping[str, Reported]:
    """A sample as the instance of the value `own` sees it.

    Its event stands for the occurrences with that value; one whose value is not known is an unknown
    occurrence in every instance.
    """
    if source.event not in values:
        return values
    seen: list[Payload | None] = []
    for payload in payloads_of(values[source.event]):
        value = None if payload is None else _known(payload, source.field)
        if value is None:
            seen.append(None)
        elif value == own:
            seen.append(payload)
    rest: dict[str, Reported] = {n: v for n, v in values.items() if n != source.event}
    if seen:
        rest[source.event] = tuple(seen)
    return rest


def _known(payload: Payload, field: str) -> Scalar:
    value = payload.get(field)
    return None if value != value else value
