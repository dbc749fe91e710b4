"""A formula of the present and past with four values: false, unknown, true, and not born yet.

No monitor has the fourth value. A formula is kept as the state formulas with three values that it
is read as, one for each value that what is not born may be taken for (`three_valued` makes them).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

from rvmon.logic.formula import Factory
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, State


class Four:
    """A formula with four values.

    Args:
        read: gives the state formula with three that is FALSE, UNKNOWN or TRUE where this one is
            not born.
        mortal: whether there is a time before its birth.
        fades: whether it is born for good as soon as it is.
        unborn: two-valued, that it is not born; default as `read` gives it.
        parts: of a conjunction, its operands; of anything else, it alone.

    Attributes:
        negated: what it is the negation of.
    """

    def __init__(
        self,
        factory: Factory,
        read: Callable[[int], State],
        *,
        mortal: bool = True,
        fades: bool = False,
        unborn: State | None = None,
        parts: Sequence[Four] = (),
    ) -> None:
        self._factory = factory
        self.read = cache(read) if mortal else same(read(UNKNOWN))
        self.mortal = mortal
        self.fades = fades
        self.parts = tuple(parts) or (self,)
        self.negated: Four | None = None
        self._unborn = unborn

    @property
    def unborn(self) -> State:
        """Two-valued: it is not born."""
        if not self.mortal:
            return self._factory.state_false
        if self._unborn is not None:
            return self._unborn
        sure, negation = self._factory.sure, self._factory.negation
        return self._factory.state_all([sure(self.read(TRUE)), sure(negation(self.read(FALSE)))])

    @property
    def missing(self) -> State:
        """TRUE where it is not born, UNKNOWN where it is unknown, else FALSE."""
        factory = self._factory
        born = self.read(TRUE)
        lost = factory.state_all([born, factory.negation(born)])
        return factory.state_any([self.unborn, lost])


def same(state: State) -> Callable[[int], State]:
    """The reading of what is born throughout: one state, whatever is asked for."""
    return lambda _: state
