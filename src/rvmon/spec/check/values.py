"""What an expression stands for while it is checked, and where its names are looked up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from rvmon.diagnostics.span import Span
from rvmon.spec.checked.formula import Formula, Measured, Numeric
from rvmon.spec.checked.specification import Event, Signal, Type
from rvmon.spec.syntax.expressions import Expression
from rvmon.spec.syntax.items import ConstItem, DefineItem
from rvmon.units import PLAIN, Unit


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number or label with its unit.

    Attributes:
        node: what yields it at run time; `None` if it is a constant.
        constant: the exact value in `unit` if it is a constant.
        unit: of the value.
        integral: whether all values are whole numbers by type.
        labels: the labels it may take, if it is one.
        truth: whether it is a bool, for which 0 and 1 stand.
    """

    node: Numeric | None = None
    constant: Fraction | None = None
    unit: Unit = PLAIN
    integral: bool = False
    labels: tuple[str, ...] = ()
    truth: bool = False


@dataclass(frozen=True, slots=True)
class Age:
    """`age(x)`: the time since the last update; only compared with durations."""

    name: str


@dataclass(frozen=True, slots=True)
class Chosen:
    """`if φ then x else y` of numbers; a comparison of it is one of each, beside φ."""

    condition: Formula
    chosen: Value
    otherwise: Value


@dataclass(frozen=True, slots=True)
class Now:
    """`now`, `now - t0`: the time since an instant; only compared, or captured by `let`.

    Attributes:
        since: the name of a captured instant; `None`: the first one.
    """

    since: str | None = None


@dataclass(frozen=True, slots=True)
class Moment:
    """An instant that was captured, or some time behind it; `now` is compared with it.

    Attributes:
        name: that it was captured by.
        later: so much time behind it; `None`: none.
    """

    name: str
    later: Quantity | None = None


@dataclass(frozen=True, slots=True)
class AmountOf:
    """`count(φ, D)`, `sum(x, D)` and their kin; only compared.

    Attributes:
        measured: a share is the duration, divided by D.
        operand: φ, or where x is added.
        window: D, ticks; `None`: since the first instant.
        share: whether it is one.
        added: x, of numbers.
    """

    measured: Measured
    operand: Formula
    window: int | None
    share: bool = False
    added: Quantity | None = None


@dataclass(frozen=True, slots=True)
class Extreme:
    """`min(x, D)`, `max(x, D)`; only compared with what stays as it is.

    Attributes:
        greatest: whether it is the greatest value of the last D, and not the least.
        quantity: x.
        span: of x.
        window: D, ticks; `None`: since the first instant.
    """

    greatest: bool
    quantity: Quantity
    span: Span
    window: int | None


@dataclass(frozen=True, slots=True)
class Ago:
    """`ago(x, D)`; only compared with what stays as it is, as an extreme is.

    Attributes:
        quantity: x.
        span: of x.
        window: D, ticks.
    """

    quantity: Quantity
    span: Span
    window: int


Beside = Age | Now | Moment | AmountOf | Extreme | Ago
"""What only stands beside something else in a comparison."""

Value = Formula | Quantity | Beside | Chosen


@dataclass(frozen=True, slots=True)
class Closure:
    """A macro's argument: an expression that keeps the names of the place it was written at."""

    expression: Expression
    scope: Scope


@dataclass(frozen=True, slots=True)
class Scope:
    """The names that hold inside a macro or requirement, besides those of the file."""

    names: Mapping[str, Closure | Quantity | Moment] = field(default_factory=dict)


EVERYWHERE = Scope()
"""Only the names of the file."""

Declaration = Signal | Event | DefineItem | ConstItem


@dataclass(frozen=True, slots=True)
class FieldOf:
    """A payload field that a dotted name stands for."""

    event: str
    field: str
    type: Type
