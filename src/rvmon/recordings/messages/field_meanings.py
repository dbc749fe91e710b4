"""The meaning of message fields, from tables about the packages that many robots use.

The folder `meanings` has a file per package: each message type in brackets, then one line per
field with its name, an entry for its meaning, and words that people use for it. The entries:

    m/s       measured in this unit; for a field that is a message, all fields in it
    rad|m     measured in one of these units, as a joint may turn or slide
    ~deg      measured in another scale of this unit
    1         a plain number, such as a ratio
    #         a count or code, a text, a truth value
    q         a part of a quaternion
    ?         decided by the sender
    -         of no interest: covariances, gains, bytes
    @p/Type   a message of this type, whose fields are listed there

The word `xyz` means that the elements of an array are along these axes.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from enum import Enum
from functools import cache, reduce
from importlib import resources

from msgspec import Struct
from msgspec.structs import replace

from rvmon.errors import TraceError
from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.comments import is_vector, spoken_unit, unit_in_comment
from rvmon.trace.schema import TURNS, Applied, Bound, Constant, Elements, Field, Kind, Schema, Term
from rvmon.units import PLAIN, Unit, parse_unit


class Sort(Enum):
    """The sorts of fields, by their entry in the tables."""

    MEASURED = "measured"
    CODE = "#"
    QUATERNION = "q"
    OPEN = "?"
    ODD = "-"


class Meaning(Struct, frozen=True):
    """The known meaning of a field."""

    sort: Sort
    # the units of which it has one; empty if it is not measured or its unit is not known
    units: tuple[Unit, ...] = ()
    is_scaled: bool = False  # whether it is in another scale of the unit
    words: tuple[str, ...] = ()  # words that people use for it
    is_prose: bool = False  # whether it comes from a comment, which may mean something else


UNKNOWN = Meaning(Sort.OPEN)  # the meaning of fields that are in no table

_UNKNOWN_UNIT = Meaning(Sort.OPEN, is_scaled=True)
"""The meaning of a field for which the recording states a unit that is not known here."""


def meaning_of(path: str, topic: Topic) -> Meaning:
    """The meaning of a field of a topic's messages: from the tables, else from the recording.

    >>> one = meaning_of("twist.linear.x", Topic("/v", "geometry_msgs/msg/TwistStamped", {}))
    >>> one.units[0].symbol, one.words
    ('m/s', ('velocity', 'speed'))
    """
    # Names of elements may have dots, which would be taken for steps of the path.
    plain = re.sub(r"\[[^\[\]]*\]", "[]", path)
    steps = plain.split(".")
    type_name = plain_type(topic.type)
    found = UNKNOWN
    for place, step in enumerate(steps, 1):
        entry = _table(type_name).get(step.removesuffix("[]"), "?")
        if not entry.startswith("@"):
            inner = _read(entry)
            # The meaning of a message, such as a vector, is that of all fields in it.
            found = inner if found.sort is Sort.OPEN else found
        way = ".".join(steps[:place])
        if found.sort is Sort.OPEN:
            found = _stated(way, topic)
        stated = entry.removeprefix("@") if entry.startswith("@") else topic.messages.get(way, "")
        type_name = plain_type(stated)
    return found


def is_listed(type_name: str) -> bool:
    """Whether the tables list the fields of a message type."""
    return bool(_table(plain_type(type_name)))


def plain_type(type_name: str) -> str:
    """The name of a type in the form of the tables.

    >>> plain_type("sensor_msgs/msg/Imu"), plain_type("sensor_msgs/Imu")
    ('sensor_msgs/Imu', 'sensor_msgs/Imu')
    """
    return re.sub(r"[/.]msg[/.]", "/", type_name)


def _stated(path: str, topic: Topic) -> Meaning:
    """The meaning that a recording states for a field, by a unit or by a comment."""
    stated = topic.units.get(path, "")
    unit = "1" if stated in ("1", "-") else spoken_unit(stated)
    is_number = topic.leaves.get(path) in (Kind.REAL, Kind.INT)
    if stated and not unit:
        return _UNKNOWN_UNIT
    comment = topic.comments.get(path)
    if not stated and comment and (is_number or is_vector(topic.messages.get(path, ""))):
        unit = unit_in_comment(comment)
    is_prose = path not in topic.units
    return replace(_read(unit), is_prose=is_prose) if unit else UNKNOWN


@cache
def _read(entry: str) -> Meaning:
    what, *words = entry.split()
    if what in ("#", "q", "?", "-"):
        return Meaning(Sort(what), words=tuple(words))
    units = tuple(parse_unit(unit) for unit in what.removeprefix("~").split("|"))
    return Meaning(Sort.MEASURED, units, what.startswith("~"), tuple(words))


def _table(type_name: str) -> Mapping[str, str]:
    """The entry of each field of a type; empty if the type is in no table."""
    package, _, name = type_name.partition("/")
    return _package(package).get(name, {}) if name else {}


@cache
def _package(name: str) -> Mapping[str, Mapping[str, str]]:
    place = resources.files("rvmon.recordings.messages") / "meanings" / f"{name}.txt"
    if not re.fullmatch(r"\w+", name) or not place.is_file():
        return {}
    found: dict[str, dict[str, str]] = {}
    own: dict[str, str] = {}
    for line in place.read_text("utf-8").splitlines():
        if line.startswith("["):
            own = found.setdefault(line.strip("[]"), {})
        else:
            field, _, entry = line.partition(" ")
            own[field] = entry
    return found


_ALIKE = frozenset({"+", "-", "min", "max", "hypot", "<", "<=", ">", ">=", "==", "!="})
"""Operations whose arguments must be in the same unit."""

_TRUTHS = frozenset({"<", "<=", ">", ">=", "==", "!=", "and", "or", "xor", "not", "any", "all"})


_PLAIN = Meaning(Sort.MEASURED, (PLAIN,))
_ANGLE = Meaning(Sort.MEASURED, (parse_unit("rad"),))


def _measured(term: Term, topic: Topic) -> Meaning:
    """The meaning of a term's value; without units if they are not known, or for a constant.

    Raises:
        TraceError: values of different dimensions are added or compared.
    """
    match term:
        case Constant():
            return UNKNOWN
        case Field() | Elements():
            meaning = meaning_of(str(term), topic)
            return _PLAIN if meaning.sort is Sort.QUATERNION else meaning
        case Applied(sign=turn) if turn in TURNS:
            return _ANGLE
        case Applied(args=(value, _), sign=""):
            return _measured(value, topic)
        case Applied(args=args, sign=sign):
            inner = [_measured(arg, topic) for arg in args]
            if sign in _ALIKE:
                _expect_alike(term, inner, topic)
            return UNKNOWN if sign in _TRUTHS else _combined(sign, args, inner)


def _combined(sign: str, args: tuple[Term, ...], inner: list[Meaning]) -> Meaning:
    """The meaning of a result, known only if the units of all arguments but constants are."""
    pairs = list(zip(args, inner, strict=True))
    known = [own for own in inner if own.units]
    if any(not own.units and not isinstance(arg, Constant) for arg, own in pairs):
        return UNKNOWN
    if not known or (sign in ("*", "/") and len(known) == 2) or sign == "sqrt":
        return UNKNOWN  # products of fields are rare, so their units need not be found out
    if sign == "/" and not inner[0].units:
        return UNKNOWN
    # Multiplying by a constant may change the scale: millimetres become metres.
    return replace(known[0], is_scaled=known[0].is_scaled or sign in ("*", "/"))


def _expect_alike(term: Applied, inner: list[Meaning], topic: Topic) -> None:
    dimensions = [{unit.dimension for unit in own.units} for own in inner if own.units]
    if dimensions and not reduce(set.intersection, dimensions):
        listed = " and ".join(
            f"`{arg}` in {_written(own.units)}"
            for arg, own in zip(term.args, inner, strict=True)
            if own.units
        )
        raise TraceError(
            f"`{term}` of topic {topic.name} ({topic.type}): {listed} cannot be added or compared"
        )


def expect_units(name: str, bound: Bound, schema: Schema, topic: Topic) -> None:
    """Check that the values that feed a name are in its unit, as far as the messages tell.

    Raises:
        TraceError: a value has another dimension, or another scale that is not converted.
    """
    if bound.value is not None:
        _expect(name, bound.value, schema.units.get(name, ""), bound.unit, topic)
    for field, term in bound.fields.items():
        full = f"{name}.{field}"
        _expect(full, term, schema.units.get(full, ""), "", topic)


def _expect(name: str, term: Term, declared: str, given: str, topic: Topic) -> None:
    found = _measured(term, topic)
    is_prose = found.is_prose
    if not found.units or not declared or (is_prose and given):
        return  # a unit in the binding takes precedence over one guessed from a comment
    target = parse_unit(given or declared)
    alike = [unit for unit in found.units if unit.dimension == target.dimension]
    where = f"topic {topic.name} ({topic.type})" if topic.type else f"topic {topic.name}"
    is_so = (
        f"`{term}` of {where} is {_written(found.units)}{', as a comment says' if is_prose else ''}"
    )
    wanted = f"`{name}` is declared [{declared}]"
    if not alike:
        otherwise = f', or write `unit = "{declared}"` in a binding if it is' if is_prose else ""
        raise TraceError(
            f"{wanted}, and {is_so}: bind a field in [{declared}]{_such(target, topic)}{otherwise}"
        )
    if found.is_scaled or any(unit.factor == target.factor for unit in alike):
        return
    why = f"and `unit` says [{given}]" if given else "and would be evaluated without conversion"
    fix = f'write `unit = "{alike[0].symbol or 1}"` in a binding, and it is converted'
    raise TraceError(f"{is_so}; {wanted}, {why}: {fix}")


def _such(target: Unit, topic: Topic) -> str:
    fields = [
        f"`{leaf}`"
        for leaf in topic.leaves
        if any(unit.dimension == target.dimension for unit in meaning_of(leaf, topic).units)
    ]
    return f", such as {' or '.join(fields[:3])}" if fields and target.dimension else ""


def _written(units: Iterable[Unit]) -> str:
    """Units as text for a message.

    >>> _written([parse_unit("rad"), PLAIN])
    'in [rad] or a plain number'
    """
    listed = [f"in [{unit.symbol}]" if unit.dimension else "a plain number" for unit in units]
    return " or ".join(dict.fromkeys(listed))
