"""The truth of each part of a requirement over a whole recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from rvmon.explain.truths import Truth, truths_of
from rvmon.spec.checked.formula import Binary, Formula, Unary, UnaryOp
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Attempt


def subformulas(formula: Formula, depth: int) -> Iterator[tuple[int, Formula]]:
    """The formula, then what it is made of; a negation of an atom is not taken apart."""
    yield depth, formula
    match formula:
        case Unary(operand=Unary() | Binary() as operand):
            yield from subformulas(operand, depth + 1)
        case Unary(op=op, operand=operand) if op is not UnaryOp.NOT:
            yield from subformulas(operand, depth + 1)
        case Binary(left=left, right=right):
            yield from subformulas(left, depth + 1)
            yield from subformulas(right, depth + 1)
        case _:
            pass


class Eye:
    """Sees the truth of what a requirement is made of over a recording."""

    def __init__(
        self,
        spec: CheckedSpec,
        requirement: Requirement,
        samples: Sequence[Sample],
        end: int,
        attempt: Attempt,
        names: frozenset[str] | None,
    ) -> None:
        self.requirement = requirement
        self._spec = spec
        self._samples = samples
        self._end = end
        self._captured = attempt.captured
        self._names = names

    @cached_property
    def _truths(self) -> dict[int, Truth]:
        requirement = self.requirement
        wholes = (requirement.trigger, requirement.consequent)
        formulas = [one for whole in wholes for _, one in subformulas(whole, 0)]
        found = truths_of(
            self._spec,
            formulas,
            self._samples,
            self._end,
            self._names,
            for_each=requirement.for_each,
            captured=self._captured,
        )
        return {id(formula): truth for formula, truth in zip(formulas, found, strict=True)}

    def truth(self, formula: Formula) -> Truth:
        """Where the trigger, what is owed, or a part of them, is true."""
        return self._truths[id(formula)]
