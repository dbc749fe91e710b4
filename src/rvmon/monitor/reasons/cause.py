"""Which part of what was owed decided an attempt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from rvmon.logic.alphabet import TruthValue, holds
from rvmon.logic.formula import (
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
from rvmon.logic.progress import Phase, after, instance, phase, step
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Atom, Residual
from rvmon.logic.state_formula import State

AT_DECISION = -2
"""The start of what was instantiated at the instant of the decision; no clock has this number."""


@dataclass(frozen=True, slots=True)
class Cause:
    """What decided.

    Attributes:
        node: the obligation, or the literal if none lies above it.
        start: what shows when the obligation was instantiated: of a run of a machine the number of
            a clock, `NO_CLOCK` if that was at the trigger, `AT_DECISION` if then; of a network
            the instant.
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
        valuation: the truths of the propositions at the decision, as the deciding run takes them.
        ages: of the clocks at the decision.
        verdict: the decision.
        by_time: whether time alone decided, without a letter.
    """

    def __init__(
        self,
        valuation: Mapping[State, TruthValue],
        ages: Sequence[int],
        *,
        verdict: bool,
        by_time: bool,
    ) -> None:
        self.valuation = valuation
        self.ages = ages
        self.verdict = verdict
        self.by_time = by_time
        self.wanted = HOLDS if verdict else FAILS

    def of(self, residual: Residual) -> Cause | None:
        """The cause of a decision, which this residual became; `None` if it is constant."""

        def decided(atom: Atom) -> bool:
            alone: Residual = frozenset([frozenset([atom])])
            left = after(alone, self.ages) if self.by_time else step(alone, self.ages, self._read)
            return left == self.wanted

        clauses = sorted(residual, key=len)
        if self.verdict:
            clauses = [c for c in clauses if all(decided(atom) for atom in c)]
        found = sorted(
            {atom for clause in clauses for atom in clause if decided(atom)},
            key=lambda atom: (atom[1], atom[0].id),
        )
        for node, clock in found:
            cause = self._of_atom(node, clock)
            if cause is not None:
                return cause
        return None

    def _read(self, literal: Literal) -> Residual:
        return HOLDS if holds(literal.sense, self.valuation[literal.proposition]) else FAILS

    def _of_atom(self, node: Literal | Next | Until | Release, clock: int) -> Cause | None:
        match node:
            case Literal():
                return Cause(node, AT_DECISION, False, node)
            case Next(operand=operand):
                return self._of_instance(operand)
            case Until() | Release():
                if clock > NO_CLOCK and phase(node, self.ages[clock]) is Phase.OVER:
                    return Cause(node, clock, True, None)
                ends_it = isinstance(node, Until) is self.verdict
                part = node.right if ends_it else node.left
                if isinstance(part, Literal):
                    return Cause(node, clock, False, part)
                return self._of_instance(part) or Cause(node, clock, False, None)
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
                return self._of_atom(node, AT_DECISION)
            case Since() | Previous():
                raise AssertionError("a residual holds nothing of the past")
            case _:
                assert_never(node)
