"""Core formulas: negation normal form over propositions.

The future operators are X, U and R. Those of the past occur only where something of the future
stands below them: else they are part of a proposition.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import assert_never

from rvmon.formula.state import State


class Sense(Enum):
    """How a literal reads its proposition; the three are independent of each other."""

    TRUE = "is true"
    FALSE = "is false"
    KNOWN_FALSE = "is known to be false"
    """Two-valued: an unknown proposition is not known to be false, however one looks at it."""


@dataclass(frozen=True, slots=True, eq=False)
class Constant:
    """True or false."""

    id: int
    value: bool


@dataclass(frozen=True, slots=True, eq=False)
class Literal:
    """A proposition, read in one sense."""

    id: int
    proposition: State
    sense: Sense


@dataclass(frozen=True, slots=True, eq=False)
class And:
    """All of its operands; at least two, in order of `id`."""

    id: int
    args: tuple[Core, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Or:
    """One of its operands; at least two, in order of `id`."""

    id: int
    args: tuple[Core, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Next:
    """The operand at the next position."""

    id: int
    operand: Core


@dataclass(frozen=True, slots=True, eq=False)
class Until:
    """`left U[low, high] right`; `opened` is the same with `low` 0, what remains in the window."""

    id: int
    left: Core
    right: Core
    low: int
    high: int | None
    opened: Until | None


@dataclass(frozen=True, slots=True, eq=False)
class Release:
    """`left R[low, high] right`; `opened` is the same with `low` 0, what remains in the window."""

    id: int
    left: Core
    right: Core
    low: int
    high: int | None
    opened: Release | None


@dataclass(frozen=True, slots=True, eq=False)
class Since:
    """`left S[low, high] right`; if `dual`, `!(!left S[low, high] !right)`."""

    id: int
    left: Core
    right: Core
    low: int
    high: int | None
    dual: bool


@dataclass(frozen=True, slots=True, eq=False)
class Previous:
    """The operand at the position before; at the first one `first`."""

    id: int
    operand: Core
    first: bool


Temporal = Next | Until | Release
Core = Constant | Literal | And | Or | Next | Until | Release | Since | Previous


def parts_of(node: Core) -> tuple[Core, ...]:
    """The operands of a formula."""
    match node:
        case Constant() | Literal():
            return ()
        case And(args=args) | Or(args=args):
            return args
        case Next(operand=operand) | Previous(operand=operand):
            return (operand,)
        case Until() | Release() | Since():
            return node.left, node.right
        case _:
            assert_never(node)


def nodes_of(formula: Core) -> Iterator[Core]:
    """A formula and all that it is made of, each once, from the top."""
    seen = {formula}
    stack = [formula]
    while stack:
        node = stack.pop()
        yield node
        fresh = [part for part in parts_of(node) if part not in seen]
        seen.update(fresh)
        stack += dict.fromkeys(fresh)


def literals(formula: Core) -> Iterator[Literal]:
    """The literals of a formula, each once."""
    return (node for node in nodes_of(formula) if isinstance(node, Literal))


def looks_back(formula: Core) -> bool:
    """Whether something of the past stands above something of the future."""
    return any(isinstance(node, Since | Previous) for node in nodes_of(formula))


def horizon(formula: Core) -> int | None:
    """The ticks after the trigger by which an attempt is decided; `None` if nothing bounds them.

    `Next` counts as nothing bounded, as its distance in time is not known.
    """
    reaches = [horizon(part) for part in parts_of(formula)]
    further = formula.high if isinstance(formula, Until | Release) else 0
    if isinstance(formula, Next) or further is None or None in reaches:
        return None
    return further + max((reach for reach in reaches if reach is not None), default=0)
