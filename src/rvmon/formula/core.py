"""Core formulas: negation normal form over propositions, with the future operators X, U and R."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

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


Temporal = Next | Until | Release
Core = Constant | Literal | And | Or | Next | Until | Release
