"""Units of measure: their table, parsing, products and quotients."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import cache

from msgspec import Struct


class Unit(Struct, frozen=True):
    """A unit: `factor` times the product of base units raised to the powers in `dimension`.

    Attributes:
        symbol: as people write it; empty for a plain number.
        dimension: base unit and exponent, sorted by base unit, no exponent zero.
        factor: exact, except that degrees and revolutions use 60 digits of π.
    """

    symbol: str
    dimension: tuple[tuple[str, int], ...] = ()
    factor: Fraction = Fraction(1)


PLAIN = Unit("")
"""The unit of a plain number."""


_PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494")

# The radian is a base unit, so that a signal without a unit cannot be compared with a limit in
# radians. Degrees Celsius are never converted to kelvins, because their zero differs.
_BASES = ("m", "kg", "s", "A", "K", "rad", "degC", "px", "B", "mol", "cd")

_DERIVED: tuple[tuple[str, str, Fraction | int], ...] = (
    ("g", "kg", Fraction(1, 1000)),
    ("t", "kg", 1000),
    ("L", "m^3", Fraction(1, 1000)),
    ("min", "s", 60),
    ("h", "s", 3600),
    ("N", "kg*m/s^2", 1),
    ("Pa", "N/m^2", 1),
    ("hPa", "N/m^2", 100),
    ("bar", "N/m^2", 100_000),
    ("J", "N*m", 1),
    ("watt", "J/s", 1),
    ("W", "J/s", 1),
    ("Wh", "J", 3600),
    ("Ah", "A*s", 3600),
    ("V", "W/A", 1),
    ("ohm", "V/A", 1),
    ("T", "N/A/m", 1),
    ("gauss", "N/A/m", Fraction(1, 10_000)),
    ("lx", "cd/m^2", 1),
    ("Hz", "1/s", 1),
    ("deg", "rad", _PI / 180),
    ("cdeg", "rad", _PI / 18_000),
    ("cdegC", "degC", Fraction(1, 100)),
    ("rev", "rad", 2 * _PI),
    ("rpm", "rad/s", 2 * _PI / 60),
    ("inch", "m", Fraction(254, 10_000)),
    ("ft", "m", Fraction(3048, 10_000)),
    ("kB", "B", 10**3),
    ("MB", "B", 10**6),
    ("GB", "B", 10**9),
    ("bit", "B", Fraction(1, 8)),
    ("kbit", "bit", 10**3),
    ("Mbit", "bit", 10**6),
    ("%", "", Fraction(1, 100)),
)
_PREFIXED = (
    *("m", "g", "s", "A", "K", "rad", "L", "N", "Pa", "bar", "J", "W", "Wh", "Ah"),
    *("V", "ohm", "T", "gauss", "Hz", "mol"),
)
_PREFIXES = {
    "n": Fraction(1, 10**9),
    "u": Fraction(1, 10**6),
    "µ": Fraction(1, 10**6),
    "m": Fraction(1, 1000),
    "c": Fraction(1, 100),
    "d": Fraction(1, 10),
    "k": Fraction(1000),
    "M": Fraction(10**6),
    "G": Fraction(10**9),
}

SPOKEN = {"A": "ampere", "W": "watt"}
"""Units written as a word after a number, because `A` and `W` are temporal operators."""

_LONGEST = 60
"""The most characters of a unit; the factor of a longer one could have thousands of digits."""

_PART = re.compile(r"([*/]?)\s*([^\s*/^]+)(?:\^(-?\d{1,2}))?\s*")


class UnknownUnitError(ValueError):
    """A part of a unit is not in the table; the part is the only argument."""


@cache
def unit_table() -> Mapping[str, Unit]:
    """All units that are a single word, with and without prefix, by symbol."""
    table = {base: Unit(base, ((base, 1),)) for base in _BASES}
    table["ampere"] = Unit("ampere", (("A", 1),))
    for symbol, definition, factor in _DERIVED:
        defined = _parse(definition, table)
        table[symbol] = Unit(symbol, defined.dimension, defined.factor * factor)
        if symbol in _PREFIXED:
            _add_prefixed(table, symbol)
    for base in _BASES:
        if base in _PREFIXED:
            _add_prefixed(table, base)
    return table


def _add_prefixed(table: dict[str, Unit], symbol: str) -> None:
    unit = table[symbol]
    for prefix, factor in _PREFIXES.items():
        name = prefix + symbol
        table.setdefault(name, Unit(name, unit.dimension, unit.factor * factor))


@cache
def parse_unit(text: str) -> Unit:
    """Parse a unit such as `m/s`, `kg*m^2` or `1/s`.

    Raises:
        UnknownUnitError: a part is unknown, or the text is not a product of parts.

    >>> parse_unit("km/h").factor
    Fraction(5, 18)
    """
    if len(text) > _LONGEST:
        raise UnknownUnitError(text)
    return _parse(text, unit_table())


def _parse(text: str, table: Mapping[str, Unit]) -> Unit:
    return _of_powers(_powers(text), table)


def _powers(text: str) -> Mapping[str, int]:
    """The simple units in a compound unit, each with its exponent."""
    powers: Counter[str] = Counter()
    place = 0
    while place < len(text):
        part = _PART.match(text, place)
        if part is None or (part[1] == "") != (place == 0):
            raise UnknownUnitError(text[place:])
        place = part.end()
        name = SPOKEN.get(part[2], part[2])
        if name != "1":
            powers[name] += int(part[3] or 1) * (-1 if part[1] == "/" else 1)
    return powers


def _of_powers(powers: Mapping[str, int], table: Mapping[str, Unit]) -> Unit:
    dimension: Counter[str] = Counter()
    factor = Fraction(1)
    for name, power in powers.items():
        unit = table.get(name)
        if unit is None:
            raise UnknownUnitError(name)
        factor *= unit.factor**power
        for base, exponent in unit.dimension:
            dimension[base] += exponent * power
    kept = tuple(sorted((base, power) for base, power in dimension.items() if power))
    return Unit(_symbol(powers), kept, factor)


def _symbol(powers: Mapping[str, int]) -> str:
    above = [_power(name, power) for name, power in powers.items() if power > 0]
    below = [_power(name, -power) for name, power in powers.items() if power < 0]
    return "/".join(("*".join(above) or ("1" if below else ""), *below))


def _power(name: str, power: int) -> str:
    return name if power == 1 else f"{name}^{power}"


def product(left: Unit, right: Unit) -> Unit:
    """The unit of a product."""
    return _combined(left, right, 1)


def quotient(left: Unit, right: Unit) -> Unit:
    """The unit of a quotient."""
    return _combined(left, right, -1)


def _combined(left: Unit, right: Unit, power: int) -> Unit:
    powers = Counter(_powers(left.symbol))
    for name, exponent in _powers(right.symbol).items():
        powers[name] += power * exponent
    return _of_powers(powers, unit_table())


def root(unit: Unit) -> Unit | None:
    """The unit of the square root of a number in base units; `None` if an exponent is odd."""
    if any(exponent % 2 for _, exponent in unit.dimension):
        return None
    return base_unit({base: exponent // 2 for base, exponent in unit.dimension})


def base_unit(dimension: Mapping[str, int]) -> Unit:
    """The product of base units with these exponents."""
    powers = {SPOKEN.get(base, base): power for base, power in dimension.items()}
    return _of_powers(powers, unit_table())


def compound_pattern(excluded: Iterable[str]) -> str:
    """A regular expression for products, quotients and powers of known units, without spaces.

    Args:
        excluded: words that are never part of a unit.
    """
    refused = frozenset(excluded)
    names = sorted((name for name in unit_table() if name not in refused), key=len, reverse=True)
    part = f"({'|'.join(name for name in names if name != '%')})(\\^-?\\d+)?"
    return rf"{part}([*/]{part})*(?![\w^]|\.\w)"
