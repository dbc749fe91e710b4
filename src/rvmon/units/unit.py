"""A unit of measure as data."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: `factor` times the product of base units to the powers of `dimension`.

    Attributes:
        symbol: as people write it; empty for a plain number.
        dimension: exponent by base unit, sorted by its symbol, none zero.
        factor: exact, but for degrees of angle (60 digits of π).
    """

    symbol: str
    dimension: tuple[tuple[str, int], ...] = ()
    factor: Fraction = Fraction(1)


PLAIN = Unit("")
"""The unit of a plain number."""
