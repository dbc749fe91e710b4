"""Limits on the depth, size and cost of expressions with their macros expanded."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.diagnostics import Span
from rvmon.language.rules import Refusal, Reported
from rvmon.language.rules import syntax as rules

DEEPEST = 100
"""Deeper nesting is refused."""

LARGEST = 5_000
"""Formulas with more operators are refused."""

BUDGET = 20_000
"""A file may expand to this and `PER_CHARACTER` operators for each of its characters."""

PER_CHARACTER = 5


@dataclass(frozen=True, slots=True)
class Cost:
    """Levels and operators of an expression."""

    depth: int
    size: int


class Effort:
    """Counts what is evaluated, and refuses what is too much of it.

    Args:
        characters: of the whole specification: a long file may do more.
    """

    def __init__(self, characters: int) -> None:
        self._depth = self._deepest = self._size = 0
        self._refused = False
        self._rest = BUDGET + PER_CHARACTER * characters

    def begin(self) -> None:
        """A new formula starts."""
        self._size = 0
        self._refused = False

    def enter(self, span: Span) -> None:
        """An operator's operands follow; `leave` has to be called in any case.

        Raises:
            Refusal: there are too many, or they are nested too deeply.
            Reported: that has been reported of this formula or file.
        """
        self._depth += 1
        self._deepest = max(self._deepest, self._depth)
        self.add(Cost(0, 1), span)
        self.spend(1, span)

    def leave(self) -> None:
        """The operands are through."""
        self._depth -= 1

    def spend(self, work: int, span: Span) -> None:
        """Take work off the budget of the file.

        Raises:
            Refusal: it is used up now.
            Reported: it was used up before.
        """
        if self._rest < 0:
            raise Reported
        self._rest -= work
        if self._rest < 0:
            raise Refusal(rules.too_much_work(span))

    def mark(self) -> Cost:
        """Start to measure what follows."""
        mark = Cost(self._deepest, self._size)
        self._deepest = self._depth
        return mark

    def since(self, mark: Cost) -> Cost:
        """The cost since the mark, without that of the mark."""
        cost = Cost(self._deepest - self._depth, self._size - mark.size)
        self._deepest, self._size = max(mark.depth, self._deepest), mark.size
        return cost

    def add(self, cost: Cost, span: Span) -> None:
        """Count an expression here.

        Raises:
            Refusal: it is too much.
            Reported: that has been reported of this formula.
        """
        self._size += cost.size
        if self._refused:
            raise Reported
        if self._depth + cost.depth > DEEPEST:
            raise Refusal(rules.too_deep(span, DEEPEST))
        if self._size > LARGEST:
            self._refused = True
            raise Refusal(rules.too_large(span, LARGEST))
