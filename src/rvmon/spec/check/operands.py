"""What comparisons and functions ask of the checker of expressions, which calls them."""

from __future__ import annotations

from typing import Protocol

from rvmon.diagnostics.span import Span
from rvmon.spec.check.table import Table
from rvmon.spec.check.values import Quantity, Scope, Value
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import Formula
from rvmon.spec.syntax.expressions import Expression


class Operands(Protocol):
    """Evaluates operands; each method reports what is wrong in all of them before it raises.

    Attributes:
        table: the names of the file.
    """

    table: Table

    def values(self, expressions: tuple[Expression, ...], scope: Scope) -> list[Value]:
        """What the operands stand for."""

    def calculated(
        self, op: NumericOp, args: tuple[Expression, ...], scope: Scope, span: Span
    ) -> Value:
        """An operation on numbers, or on choices between them."""

    def quantities(self, expressions: tuple[Expression, ...], scope: Scope) -> list[Quantity]:
        """The same, which have to be numbers."""

    def formula(self, expression: Expression, scope: Scope) -> Formula:
        """What an operand stands for, which has to be a formula."""

    def duration(self, expression: Expression, scope: Scope) -> int:
        """What it stands for, which has to be a constant duration, in ticks."""

    def known(self, name: str, scope: Scope) -> bool:
        """Whether a name stands for anything but a label."""

    def peeled(self, expression: Expression, scope: Scope) -> tuple[Expression, Scope]:
        """An operand without brackets and macro parameters around it."""
