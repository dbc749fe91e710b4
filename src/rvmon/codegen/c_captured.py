"""Captured values as compiled monitors give them, in doubles, and as Python has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rvmon.codegen.c_exact import is_whole, spelt_out
from rvmon.codegen.c_names import Names
from rvmon.formula.numeric import operands
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import (
    FieldValue,
    Literal,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)
from rvmon.spec.checked.specification import Type
from rvmon.trace.sample import Scalar
from rvmon.trace.schema import Kind

_WHOLE = Type(Kind.INT)
_REAL = Type(Kind.REAL)
_LABEL = Type(Kind.LABEL)


class CapturedValues:
    """Reads captured values.

    Args:
        plan: of the monitor.

    Attributes:
        count: the most that an attempt has.
        names: by number of the requirement, what each of them is called, and its type.
    """

    def __init__(self, plan: Plan) -> None:
        self._labels = {number: label for label, number in Names(plan).labels.items()}
        self.names: Sequence[Mapping[str, Type]] = [
            {name: _type(plan, value) for name, value in spelt_out(rule.requirement).items()}
            for rule in plan.asked
        ]
        self.count = max(map(len, self.names), default=0)

    def of(self, requirement: int, values: Sequence[float]) -> dict[str, Scalar]:
        """What an attempt captured, by name.

        Args:
            requirement: its number.
            values: in their order; there may be more.
        """
        own = self.names[requirement].items()
        return {
            name: self._value(value, type_)
            for (name, type_), value in zip(own, values, strict=False)
        }

    def _value(self, value: float, type_: Type) -> Scalar:
        if value != value:
            return None
        match type_.kind:
            case Kind.BOOL:
                return bool(value)
            case Kind.INT:
                return int(value)
            case Kind.LABEL:
                return self._labels[int(value)]
            case _:
                return float(value)


def _type(plan: Plan, value: Numeric) -> Type:
    match value:
        case SignalValue(name=name):
            return plan.spec.signals[name].type
        case FieldValue(event=event, field=field):
            return plan.spec.events[event].fields[field]
        case UpdateValue(function=UpdateFunction.PREV, name=name):
            return plan.spec.signals[name].type
        case Literal(value=str()):
            return _LABEL
        case _:
            whole = is_whole(value) and all(_is_whole(plan, part) for part in operands(value))
            return _WHOLE if whole else _REAL


def _is_whole(plan: Plan, part: Numeric) -> bool:
    match part:
        case UpdateValue(name=name) | SignalValue(name=name):
            return plan.spec.signals[name].type.kind is Kind.INT
        case FieldValue(event=event, field=field):
            return plan.spec.events[event].fields[field].kind is Kind.INT
        case _:
            return True
