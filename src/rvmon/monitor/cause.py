"""Which part of what was owed decided an attempt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from rvmon.formula.alphabet import Cell, holds
from rvmon.formula.core import (
    And,
    Constant,
    Core,
    Literal,
    Next,
    Or,
    Previous,
    Release,
    Since,
    Until,
)
from rvmon.formula.progress import Phase, after, instance, phase, step
from rvmon.formula.residual import FAILS, HOLDS, NO_CLOCK, Atom, Residual
from rvmon.formula.state import State


@dataclass(frozen=True, slots=True)
class Cause:
    """What decided.

    Attributes:
        node: the obligation, or the literal if none lies above it.
        start: the instant at which the obligation was instantiated.
        over: whether its window passed; else `literal` decided it at the instant of decision.
        literal: the proposition that decided it, if a single one did.
    """

    node: Literal | Until | Release
    start: int
    over: bool
    literal: Literal | None


class CauseFinder:
    """Looks for the cause of a decision.

    Args:
        cells: what the propositions are at the decision, as the deciding run takes them.
        t: the instant of the decision.
        triggered: the instant of the trigger; stands for those that no clock remembers.
        verdict: the decision.
        by_time: whether time alone decided, without a letter at `t`.
    """

    def __init__(
        self,
        cells: Mapping[State, Cell],
        t: int,
        triggered: int,
        *,
        verdict: bool,
        by_time: bool,
    ) -> None:
        self.cells = cells
        self.t = t
        self.triggered = triggered
        self.verdict = verdict
        self.by_time = by_time
        self.wanted = HOLDS if verdict else FAILS

    def of(self, residual: Residual, anchors: Sequence[int]) -> Cause | None:
        """The cause of a decision, which this residual became at `t`; `None` if it is constant."""
        ages = [self.t - anchor for anchor in anchors]

        def decided(atom: Atom) -> bool:
            alone: Residual = frozenset([frozenset([atom])])
            left = after(alone, ages) if self.by_time else step(alone, ages, self._read)
            return left == self.wanted

        clauses = sorted(residual, key=len)
        if self.verdict:
            clauses = [c for c in clauses if all(decided(atom) for atom in c)]
        found = sorted(
            {atom for clause in clauses for atom in clause if decided(atom)},
            key=lambda atom: (atom[1], atom[0].id),
        )
        for node, clock in found:
            start = self.triggered if clock == NO_CLOCK else anchors[clock]
            cause = self._of_atom(node, start)
            if cause is not None:
                return cause
        return None

    def _read(self, literal: Literal) -> Residual:
        return HOLDS if holds(literal.sense, self.cells[literal.proposition]) else FAILS

    def _of_atom(self, node: Literal | Next | Until | Release, start: int) -> Cause | None:
        match node:
            case Literal():
                return Cause(node, self.t, False, node)
            case Next(operand=operand):
                return self._of_instance(operand)
            case Until() | Release():
                if phase(node, self.t - start) is Phase.OVER:
                    return Cause(node, start, True, None)
                ends_it = isinstance(node, Until) is self.verdict
                part = node.right if ends_it else node.left
                if isinstance(part, Literal):
                    return Cause(node, start, False, part)
                return self._of_instance(part) or Cause(node, start, False, None)
            case _:
                assert_never(node)

    def _of_instance(self, node: Core) -> Cause | None:
        match node:
            case Constant():
                return None
            case And(args=args) | Or(args=args):
                decided = [arg for arg in args if instance(arg, self._read) == self.wanted]
                # What is owed over time says more than what was only asked for besides.
                decided.sort(key=lambda arg: isinstance(arg, Literal))
                causes = (self._of_instance(arg) for arg in decided)
                return next((cause for cause in causes if cause is not None), None)
            case Literal() | Next() | Until() | Release():
                return self._of_atom(node, self.t)
            case Since() | Previous():
                raise AssertionError("a residual holds nothing of the past")
            case _:
                assert_never(node)
