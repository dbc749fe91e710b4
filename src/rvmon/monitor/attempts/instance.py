"""`for each x in e.f`: what an instance sees of its event, and which values occur."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.plan.inputs import Reported, payloads_of
from rvmon.plan.instances import occurrences_with
from rvmon.spec.checked.formula import FieldValue
from rvmon.trace.sample import Payload, Scalar, Value

Shape = tuple[
    list[tuple[str, list[tuple[int, Scalar, int]]]],
    list[tuple[str, str, dict[str, Scalar], Scalar, bool, bool]],
]
"""Per requirement its instances: rank, value, first instant; per evaluator its requirement,
which of its judges it has, captured values, the value of its instance, whether attempts start in
it, and whether it is still seen to whether its values stay known."""


@dataclass(frozen=True, slots=True)
class Instance:
    """One value of a `for each`, or whatever value those occurrences have that do not report it.

    Attributes:
        rank: from 1, in order of first occurrence; 0 where the value is not known.
        source: the field that the value came from.
        value: the value; `None` if it is not known.
        first: the instant of the first occurrence of the value.
    """

    rank: int
    source: FieldValue
    value: Scalar
    first: int


def values_in(source: FieldValue, values: Mapping[str, Value]) -> list[Scalar]:
    """The values of the field in a sample, in order; `None` is an unknown one."""
    return [
        None if payload is None else _known(payload, source.field)
        for payload in payloads_of(values.get(source.event, False))
    ]


def seen_by(instance: Instance | None, values: Mapping[str, Reported]) -> Mapping[str, Reported]:
    """A sample as an instance sees it.

    Its event stands for the occurrences with its value; one whose value is not known is an unknown
    occurrence in every instance. Outside of instances all is seen.
    """
    if instance is None or instance.source.event not in values:
        return values
    source = instance.source
    seen = occurrences_with(source, instance.value, values[source.event])
    rest: dict[str, Reported] = {n: v for n, v in values.items() if n != source.event}
    if seen:
        rest[source.event] = seen
    return rest


def _known(payload: Payload, field: str) -> Scalar:
    value = payload.get(field)
    return None if value != value else value
