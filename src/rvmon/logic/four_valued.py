"""A formula of the present and past with four values: false, unknown, true and unborn.

No monitor represents the fourth value. A four-valued formula is a family of three-valued state
formulas, one per value that unborn may be replaced by; `three_valued` builds them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial

from rvmon.logic.formula import Factory
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, State


class Four:
    """A formula with four values.

    Args:
        read: for FALSE, UNKNOWN or TRUE, returns the three-valued formula that has this value where
            the four-valued one is unborn.
        born_late: whether it is unborn at some position.
        stays_born: whether it is never unborn again once it was born.
        unborn: two-valued, TRUE where it is unborn; by default derived from `read`.
        parts: the operands of a conjunction; by default the formula itself.
    """

    def __init__(
        self,
        factory: Factory,
        read: Callable[[int], State],
        *,
        born_late: bool = True,
        stays_born: bool = False,
        unborn: State | None = None,
        parts: Sequence[Four] = (),
    ) -> None:
        self._factory = factory
        self.read = cache(read) if born_late else partial(_same, read(UNKNOWN))
        self.born_late = born_late
        self.stays_born = stays_born
        self.parts = tuple(parts) or (self,)
        # the formula of which this one is the negation, if it was made as one
        self.negated: Four | None = None
        self._unborn = unborn

    @property
    def unborn(self) -> State:
        """Two-valued: TRUE where the formula is unborn."""
        if not self.born_late:
            return self._factory.state_false
        if self._unborn is not None:
            return self._unborn
        sure, negation = self._factory.sure, self._factory.negation
        return self._factory.state_all([sure(self.read(TRUE)), sure(negation(self.read(FALSE)))])

    @property
    def missing(self) -> State:
        """TRUE where the formula is unborn, UNKNOWN where it is unknown, else FALSE."""
        factory = self._factory
        born = self.read(TRUE)
        lost = factory.state_all([born, factory.negation(born)])
        return factory.state_any([self.unborn, lost])


def _same(state: State, _: int) -> State:
    """The `read` of a formula that is never unborn: one state for every replacement."""
    return state
