"""Random formulas of future operators over the Boolean signals of the test vocabulary."""

from __future__ import annotations

from dataclasses import replace

from rvmon.language.checked.formula import Binary, BoundAtom, Formula, Interval, SignalAtom, Unary
from rvmon.testing.generate import BOOLS, Rng, pick
from rvmon.testing.generate.formula import formula
from rvmon.testing.generate.numbers import Shape
from tests.tools.build import with_operands

_SHAPE = Shape(past=False, numbers=False, events=False, constants=0, longest=3)


def random_ltl(rng: Rng, depth: int) -> Formula:
    """A random untimed formula of future operators, at most `depth` of them nested."""
    return _over_signals(rng, formula(rng, replace(_SHAPE, step=True), depth), is_timed=False)


def random_mtl(rng: Rng, depth: int) -> Formula:
    """A random formula of future operators with windows of a few ticks, without `X`."""
    return _over_signals(rng, formula(rng, _SHAPE, depth), is_timed=True)


def _over_signals(rng: Rng, made: Formula, *, is_timed: bool) -> Formula:
    """The formula without `start`, and perhaps without bounds."""
    if isinstance(made, BoundAtom):
        return SignalAtom(pick(rng, BOOLS))
    if isinstance(made, Unary | Binary) and made.interval is not None and not is_timed:
        made = replace(made, interval=Interval())
    return with_operands(made, lambda operand: _over_signals(rng, operand, is_timed=is_timed))
