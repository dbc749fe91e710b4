"""Captured values as the core gives them, in numbers, and as Python has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rvmon.spec.checked.formula import (
    Captured,
    FieldValue,
    Literal,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.trace.sample import Scalar
from rvmon.trace.schema import Kind


class CapturedValues:
    """Reads captured values.

    Args:
        spec: the specification.
        ids: of the requirements, in the order of their numbers.
        labels: by label, its number.
    """

    def __init__(self, spec: CheckedSpec, ids: Sequence[str], labels: Mapping[str, int]) -> None:
        self._kinds = [_kinds(spec, spec.requirements[one]) for one in ids]
        self._labels = {number: label for label, number in labels.items()}

    def of(self, requirement: int, numbers: Sequence[float | None]) -> dict[str, Scalar]:
        """What an attempt captured, by name.

        Args:
            requirement: its number.
            numbers: in their order, `None` where one is not known; there may be more.
        """
        own = self._kinds[requirement].items()
        return {
            name: self._value(number, kind)
            for (name, kind), number in zip(own, numbers, strict=False)
        }

    def _value(self, number: float | None, kind: Kind | None) -> Scalar:
        if number is None:
            return None
        if kind is Kind.BOOL:
            return bool(number)
        return self._labels[int(number)] if kind is Kind.LABEL else number


def _kinds(spec: CheckedSpec, requirement: Requirement) -> dict[str, Kind | None]:
    """By name, what a requirement captures; `None`: a number, which says itself of what kind."""
    found: dict[str, Kind | None] = {}
    each = requirement.for_each
    if each is not None:
        found[each.name] = _kind(spec, each.value, found)
    for capture in requirement.captures:
        found[capture.name] = _kind(spec, capture.value, found)
    return found


def _kind(spec: CheckedSpec, value: Numeric, found: Mapping[str, Kind | None]) -> Kind | None:
    match value:
        case SignalValue(name=name) | UpdateValue(function=UpdateFunction.PREV, name=name):
            return spec.signals[name].type.kind
        case FieldValue(event=event, field=field):
            return spec.events[event].fields[field].kind
        case Captured(name=name):
            return found[name]
        case Literal(value=str()):
            return Kind.LABEL
        case _:
            return None
