"""Letters: what a formula can tell apart of the values of its propositions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import assert_never

from rvmon.formula.core import (
    And,
    Constant,
    Core,
    Literal,
    Next,
    Or,
    Previous,
    Release,
    Sense,
    Since,
    Until,
)
from rvmon.formula.state import State


class Cell(Enum):
    """The value of a proposition as one run takes it: an unknown one in the worse or better way."""

    FALSE = 0
    TRUE = 1
    UNKNOWN_PESSIMISTIC = 2
    UNKNOWN_OPTIMISTIC = 3


_TRUE_CELLS = {
    Sense.TRUE: frozenset({Cell.TRUE, Cell.UNKNOWN_OPTIMISTIC}),
    Sense.FALSE: frozenset({Cell.FALSE, Cell.UNKNOWN_OPTIMISTIC}),
    Sense.KNOWN_FALSE: frozenset({Cell.FALSE}),
}


def holds(sense: Sense, cell: Cell) -> bool:
    """Whether a literal of this sense is true where its proposition is in this cell."""
    return cell in _TRUE_CELLS[sense]


@dataclass(frozen=True, slots=True)
class Alphabet:
    """How the values of propositions make up a letter, a number below `size`.

    A letter is the sum of one entry per proposition of `pessimistic` (or `optimistic`), taken at
    the proposition's value.

    Attributes:
        propositions: in the order of their digits.
        cells: per proposition and digit, a cell that stands for all that the formula cannot tell
            from it.
        strides: per proposition, the weight of its digit.
        pessimistic: per proposition, what FALSE, UNKNOWN and TRUE contribute.
        optimistic: the same with unknown taken the better way.
        size: the number of letters.
    """

    propositions: tuple[State, ...]
    cells: tuple[tuple[Cell, ...], ...]
    strides: tuple[int, ...]
    pessimistic: tuple[tuple[int, int, int], ...]
    optimistic: tuple[tuple[int, int, int], ...]
    size: int

    def cells_of(self, letter: int) -> dict[State, Cell]:
        """What each proposition is in a letter."""
        return {
            proposition: cells[letter // stride % len(cells)]
            for proposition, cells, stride in zip(
                self.propositions, self.cells, self.strides, strict=True
            )
        }


def alphabet_of(formula: Core) -> Alphabet:
    """The least alphabet for a formula.

    A proposition read in one sense only needs two digits, unknown or not.
    """
    senses: dict[State, set[Sense]] = {}
    for literal in literals(formula):
        senses.setdefault(literal.proposition, set()).add(literal.sense)
    propositions = tuple(sorted(senses, key=lambda state: state.id))
    stride = 1
    strides, all_cells, pessimistic, optimistic = [], [], [], []
    for proposition in propositions:
        cells, digit = _digits(senses[proposition])
        strides.append(stride)
        all_cells.append(cells)
        low, high = digit[Cell.FALSE] * stride, digit[Cell.TRUE] * stride
        pessimistic.append((low, digit[Cell.UNKNOWN_PESSIMISTIC] * stride, high))
        optimistic.append((low, digit[Cell.UNKNOWN_OPTIMISTIC] * stride, high))
        stride *= len(cells)
    return Alphabet(
        propositions,
        tuple(all_cells),
        tuple(strides),
        tuple(pessimistic),
        tuple(optimistic),
        stride,
    )


def _digits(senses: set[Sense]) -> tuple[tuple[Cell, ...], dict[Cell, int]]:
    """One digit per set of cells that the senses cannot tell apart."""
    seen: dict[tuple[bool, ...], int] = {}
    cells: list[Cell] = []
    digit: dict[Cell, int] = {}
    ordered = sorted(senses, key=lambda sense: sense.value)
    for cell in Cell:
        look = tuple(holds(sense, cell) for sense in ordered)
        if look not in seen:
            seen[look] = len(cells)
            cells.append(cell)
        digit[cell] = seen[look]
    return tuple(cells), digit


def literals(formula: Core) -> Iterator[Literal]:
    """The literals of a formula, each once."""
    seen: set[Core] = set()
    stack = [formula]
    while stack:
        node = stack.pop()
        if node in seen:
            continue
        seen.add(node)
        match node:
            case Constant():
                pass
            case Literal():
                yield node
            case And(args=args) | Or(args=args):
                stack.extend(args)
            case Next(operand=operand) | Previous(operand=operand):
                stack.append(operand)
            case (
                Until(left=left, right=right)
                | Release(left=left, right=right)
                | Since(left=left, right=right)
            ):
                stack += [left, right]
            case _:
                assert_never(node)
