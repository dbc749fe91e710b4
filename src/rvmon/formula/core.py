"""Core formulas: negation normal form over propositions.

The future operators are X, U and R. Those of the past occur only where something of the future
stands below them: else they are part of a proposition.
"""

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
