"""What the fields of messages mean: facts about the packages that many robots use.

The tables are in `meanings`, a file per package: its messages in brackets, below each of them a
field a line, what it is, and words that people use for it. What a field is:

    m/s       measured in this unit; of a field that is a message: all that is inside
    rad|m     in one of these: of a joint that turns, or slides
    ~deg      in another scale of this unit
    1         a plain number, such as a ratio
    #         what counts or stands for something: a code, a text, a truth value
    q         a part of a quaternion
    ?         decided by whoever sends it
    -         of no interest: covariances, gains, bytes
    @p/Type   a message, whose fields are listed there

`xyz` among the words says that the elements of an array are along these axes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache
from importlib import resources

from rvmon.readers.messages.comments import is_vector, spoken_unit, unit_in_comment
from rvmon.readers.messages.topic import Topic
from rvmon.trace.schema import Kind
from rvmon.units import Unit, parse_unit


class Sort(Enum):
    """What a field is."""

    MEASURED = "measured"
    CODE = "#"
    QUATERNION = "q"
    OPEN = "?"
    ODD = "-"


@dataclass(frozen=True, slots=True)
class Meaning:
    """What is known of a field.

    Attributes:
        sort: what it is.
        units: in one of which it is measured; empty if it is not, or nobody knows.
        is_scaled: whether it is in another scale of the unit.
        words: that people use for it.
    """

    sort: Sort
    units: tuple[Unit, ...] = ()
    is_scaled: bool = False
    words: tuple[str, ...] = ()


UNKNOWN = Meaning(Sort.OPEN)
"""Of fields that stand in no table."""


def meaning_of(path: str, topic: Topic) -> Meaning:
    """What a field of the messages of a topic means.

    Args:
        path: of the field, as in `topic.leaves`.
        topic: of the messages.

    >>> one = meaning_of("twist.linear.x", Topic("/v", "geometry_msgs/msg/TwistStamped", {}))
    >>> one.units[0].symbol, one.words
    ('m/s', ('velocity', 'speed'))
    """
    # Names of elements may have dots.
    plain = re.sub(r"\[[^\[\]]*\]", "[]", path)
    steps = plain.split(".")
    type_name = plain_type(topic.type)
    found = UNKNOWN
    for place, step in enumerate(steps, 1):
        entry = _table(type_name).get(step.removesuffix("[]"), "?")
        if not entry.startswith("@"):
            inner = _read(entry)
            # What is said of a vector is said of all that is inside it.
            found = inner if found.sort is Sort.OPEN else found
        way = ".".join(steps[:place])
        if found.sort is Sort.OPEN:
            found = _told(way, topic)
        told = entry.removeprefix("@") if entry.startswith("@") else topic.messages.get(way, "")
        type_name = plain_type(told)
    return found


def is_listed(type_name: str) -> bool:
    """Whether the fields of a type of messages are in the tables."""
    return bool(_table(plain_type(type_name)))


def plain_type(type_name: str) -> str:
    """A type as the tables have it.

    >>> plain_type("sensor_msgs/msg/Imu"), plain_type("sensor_msgs/Imu")
    ('sensor_msgs/Imu', 'sensor_msgs/Imu')
    """
    return re.sub(r"[/.]msg[/.]", "/", type_name)


def _told(path: str, topic: Topic) -> Meaning:
    """What a recording says of a field, itself or by a comment on a number or a vector."""
    unit = topic.units.get(path, "")
    is_number = topic.leaves.get(path) in (Kind.REAL, Kind.INT)
    if unit:
        unit = "1" if unit == "1" else spoken_unit(unit)
    elif path in topic.told and (is_number or is_vector(topic.messages.get(path, ""))):
        unit = unit_in_comment(topic.told[path])
    return _read(unit) if unit else UNKNOWN


@cache
def _read(entry: str) -> Meaning:
    what, *words = entry.split()
    if what in ("#", "q", "?", "-"):
        return Meaning(Sort(what), words=tuple(words))
    units = tuple(parse_unit(unit) for unit in what.removeprefix("~").split("|"))
    return Meaning(Sort.MEASURED, units, what.startswith("~"), tuple(words))


def _table(type_name: str) -> Mapping[str, str]:
    """The entry of each field of a type; empty if it is in no table."""
    package, _, name = type_name.partition("/")
    return _package(package).get(name, {}) if name else {}


@cache
def _package(name: str) -> Mapping[str, Mapping[str, str]]:
    place = resources.files("rvmon.readers.messages") / "meanings" / f"{name}.txt"
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
