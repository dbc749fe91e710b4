"""Units in the comments of message definitions, which are beside a field or above it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from rvmon.units import UnknownUnitError, parse_unit

_SPOKEN = {
    "m": "meter metre",
    "km": "kilometer kilometre",
    "cm": "centimeter centimetre",
    "mm": "millimeter millimetre",
    "s": "second sec",
    "ms": "millisecond msec",
    "us": "microsecond usec",
    "ns": "nanosecond nsec",
    "min": "minute",
    "h": "hour hr",
    "rad": "radian",
    "deg": "degree °",
    "degC": "celsius centigrade",
    "K": "kelvin",
    "V": "volt",
    "mV": "millivolt",
    "A": "amp ampere",
    "mA": "milliamp milliampere",
    "W": "watt",
    "N": "newton",
    "N*m": "newton-meter nm n-m",
    "Pa": "pascal",
    "kPa": "kpa",
    "hPa": "hpa",
    "Hz": "hertz hz",
    "kg": "kilogram",
    "%": "percent percentage",
    "km/h": "kph kmh",
    "m/s": "mps",
    "T": "tesla",
    "gauss": "gauss",
    "mgauss": "mgauss",
    "B": "byte",
    "ohm": "ohm",
    "Wh": "w.h",
    "J": "joule",
    "L": "litre liter",
}
"""Words that people write for a unit, by unit."""

_UNITS = {word: unit for unit, words in _SPOKEN.items() for word in words.split()}

_WRITTEN = {
    r"^(units?|in|si)\b[:\s]*": "",
    r"^(deg\w*\s*|°)?c(elsius)?$": "degC",
    r"^deg(heading|latitude|longitude)$": "deg",
    r"\s+per\s+|\s*/\s*": "/",
    r"(?<=/s|ec)2$": "^2",
    r"/s(ec\w*)?/s(ec\w*)?$": "/s^2",
}
"""Replacements for other spellings of units, by pattern."""

_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]")

_BEHIND_IN = re.compile(
    r"\bin (?:units of )?(\S+(?: (?:celsius|c\b|per \w+|meters?))?)", re.IGNORECASE
)

_POWER = r"(?:0?\.0*1|10+|1e-?\d|10\^-?\d)"

_SCALE = re.compile(rf"(?<![\d.]){_POWER}\s*\*?\s*(?=[a-zA-Z])|\s*[*/x]\s*{_POWER}$|E\d$")
"""A power of ten beside a unit, which means tenths, or hundreds, of the unit."""

_FIELD = re.compile(r"(?P<type>[\w/]+)(?:<=\d+)?(?:\[[^\]]*\])?\s+(?P<name>\w+)[^=]*")


def spoken_unit(text: str) -> str:
    """Convert a unit written by a person to the language's spelling; "" if it is none.

    A `~` before the unit means another scale of it.

    >>> spoken_unit("rad/sec"), spoken_unit("Degrees Celsius"), spoken_unit("10mA")
    ('rad/s', 'degC', '~mA')
    >>> spoken_unit("deg / 1e-7"), spoken_unit("degheading"), spoken_unit("mGauss")
    ('~deg', 'deg', 'mgauss')
    """
    plain = text.strip(" .:").replace("**", "^").replace("²", "^2")
    plain, is_scaled = _SCALE.subn("", plain, count=1)
    for pattern, written in _WRITTEN.items():
        plain = re.sub(pattern, written, plain, flags=re.IGNORECASE)
    parts = [_part(part) for part in plain.split("/")]
    try:
        found = parse_unit("/".join(parts))
    except UnknownUnitError:
        return ""
    # `g` is ambiguous: a gram, or the acceleration of gravity.
    return "" if found.symbol in ("", "g") else f"{'~' * is_scaled}{found.symbol}"


def _part(text: str) -> str:
    base, caret, power = text.strip().partition("^")
    word = base.casefold().replace(" ", "-")
    known = _UNITS.get(word) or _UNITS.get(word.removesuffix("s"), "")
    return f"{known or base}{caret}{power}"


def unit_in_comment(comment: str) -> str:
    """The unit that a comment states; "" if it states none.

    >>> unit_in_comment("Tire pressures (kPa)"), unit_in_comment("left wheel in rad/sec.")
    ('kPa', 'rad/s')
    >>> unit_in_comment("voltage in 0.1V (16.1V -> 161)"), unit_in_comment("Figure of merit")
    ('~V', '')
    """
    candidates = [*_BRACKETS.findall(comment), *_BEHIND_IN.findall(comment), comment]
    units = (spoken_unit(re.split(r"[,;]|\s-\s", one)[0]) for one in candidates)
    return next(filter(None, units), "")


def comments_of(definition: str) -> Mapping[str, Mapping[str, str]]:
    r"""The comments in the text of a definition: by type ("" for the first), by field.

    A comment above a field belongs to the next field. A comment in the plural, `# speeds (m/s)`,
    belongs to all following fields of the same type.

    >>> comments_of("# Speeds (rad/s)\nfloat32 left\nfloat32 right\nbool ok  # in use")
    {'': {'left': 'Speeds (rad/s)', 'right': 'Speeds (rad/s)', 'ok': 'in use'}}
    """
    found: dict[str, dict[str, str]] = {}
    for part in re.split(r"^=+$", definition, flags=re.MULTILINE):
        named = re.match(r"\s*MSG: (\S+)", part)
        own = dict(_comments_in(part))
        if own:
            found["" if named is None else named[1].replace("/msg/", "/")] = own
    return found


def _comments_in(part: str) -> Iterator[tuple[str, str]]:
    above, kind, trailing = "", "", ""
    for line in part.splitlines():
        code, _, comment = line.partition("#")
        field = _FIELD.fullmatch(code.strip())
        if field is None:
            is_more = bool(trailing) and line[:1].isspace()
            above, kind = comment if not code.strip() and not is_more else "", ""
            continue
        of_several = kind == field["type"] and re.search(r"\w\ws\b", above)
        trailing = comment.strip()
        if text := trailing or (above.strip() if not kind or of_several else ""):
            yield field["name"], text
        kind = kind or field["type"]


def is_vector(type_name: str) -> bool:
    """Whether a type is a vector, so that a comment on it is true of each of its fields.

    >>> is_vector("geometry_msgs/Vector3"), is_vector("geometry_msgs/Pose")
    (True, False)
    """
    return bool(re.search(r"(?:^|/)(?:Vector3|Point)\w*$", type_name))
