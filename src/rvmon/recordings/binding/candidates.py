"""Candidates for declared names in a recording: fields, values computed from them, their ranges."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from typing import Any

from msgspec import Struct, field

from rvmon.errors import TraceError
from rvmon.recordings.binding.expression import number, term_of
from rvmon.recordings.binding.vocabulary import (
    AXES,
    EMPTY,
    MODIFIERS,
    OF_COMMENTS,
    OF_TOPICS,
    PLACES,
    Dimension,
    dimensions_of,
    unit_in_name,
    words_of,
)
from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.field_meanings import UNKNOWN, Meaning, Sort, is_listed, meaning_of
from rvmon.recordings.messages.fields import Get, arrays_with_names, getter
from rvmon.recordings.messages.file import MOST, MessageFile, TopicNames
from rvmon.recordings.values import plain
from rvmon.texts import shorten
from rvmon.trace.schema import TURNS, Kind
from rvmon.units import Unit, parse_unit

_ALONG: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "m/s": {
        "x": ("forward", "longitudinal", "surge"),
        "y": ("lateral", "sideways", "sway"),
        "z": ("vertical", "climb", "rate", "heave"),
    },
    "m/s^2": {"x": ("forward", "longitudinal"), "y": ("lateral", "sideways"), "z": ("vertical",)},
    "rad/s": {"x": ("roll",), "y": ("pitch",), "z": ("yaw", "turn")},
}
"""By unit and axis of a robot, the words for a quantity along the axis, or about it."""

ALONG = frozenset(
    {word for axes in _ALONG.values() for words in axes.values() for word in words}
    | {"altitude", "height"}  # positions along z, which points upwards in ROS
) - {"rate"}
"""Words that imply an axis without naming its letter."""

_COMMANDS = frozenset({"command", "trajectory", "jog"})

_COMMANDING = re.compile(r"Ackermann|Trajectory|Setpoint|Command|Target|Goal|Jog")
"""A pattern for the types of messages that are commands."""


class Candidate(Struct, frozen=True):
    """A candidate source of a declared name."""

    topic: Topic  # of the messages
    value: str  # an expression; "": each message is an occurrence
    kind: Kind | None  # of the value; `None` if each message is an occurrence
    own: tuple[str, ...]  # words of the value and of its meaning
    around: tuple[str, ...]  # words of the topic, its frames and its type
    meaning: Meaning  # of the field, or of the computed result
    axis: str = ""  # the axis along which it is measured, or ""
    comment_words: tuple[str, ...] = ()  # words of a comment on it
    implied: tuple[str, ...] = ()  # words that people use for it, given its axis, or for a joint

    @property
    def key(self) -> tuple[str, str]:
        """The topic's name and the expression, which identify the values."""
        return self.topic.name, self.value

    @property
    def is_command(self) -> bool:
        """Whether it is a command (what should be), not a measurement (what is)."""
        words = {*words_of(self.topic.name), *self.own}
        return not _COMMANDS.isdisjoint(words) or bool(_COMMANDING.search(self.topic.type))

    @property
    def is_code(self) -> bool:
        """Whether it may be a code: an integer without a known dimension."""
        return self.kind is Kind.INT and not self.dimensions

    @property
    def unit(self) -> Unit | None:
        """The unit that the messages or the name of the field state; `None` if they do not."""
        if self.meaning.sort is Sort.MEASURED and len(self.meaning.units) == 1:
            return self.meaning.units[0]
        named = unit_in_name(self.value) if self.meaning.sort is Sort.OPEN else ""
        return parse_unit(named) if named else None

    @property
    def states_unit(self) -> bool:
        """Whether the messages or the name of the field state its unit, maybe as one of several."""
        return self.meaning.sort is Sort.MEASURED or self.unit is not None

    @property
    def dimensions(self) -> frozenset[Dimension]:
        """The possible dimensions; guessed from its words if no unit is stated."""
        if self.meaning.sort is Sort.MEASURED:
            return frozenset(unit.dimension for unit in self.meaning.units)
        if self.unit is not None:
            return frozenset({self.unit.dimension})
        return dimensions_of(self.own) or dimensions_of(words_of(self.topic.name))


def candidates_of(topic: Topic, named: TopicNames) -> Iterator[Candidate]:
    """Yield the candidates of a topic: fields of its messages, and values computed from them."""
    frames = [word for frame in sorted(named.frames) for word in words_of(frame)]
    type_words = words_of(topic.type.rpartition("/")[2]) if is_listed(topic.type) else []
    around = tuple(dict.fromkeys([*words_of(topic.name), *frames, *type_words]))
    with_names = arrays_with_names(topic)
    # In flight stacks z points down, so that a value along z is neither a height nor a climb rate.
    # Types of MAVLink and of ArduPilot's logs are in capitals.
    is_down = topic.type.startswith("px4_msgs/") or topic.type.isupper() or "ned" in around
    for leaf, kind in topic.leaves.items():
        meaning = meaning_of(leaf, topic)
        if leaf.startswith("header.") or meaning.sort is Sort.ODD or "covariance" in leaf:
            continue
        for value, own, axis in _places(leaf, meaning, named, with_names):
            sunk = axis == "z" and is_down
            words = tuple(word for word in own if not (sunk and word in ALONG))
            implied = () if sunk else _implied(value, own, meaning, axis)
            comments = tuple(words_of(topic.comments.get(leaf, "")))
            yield Candidate(topic, value, kind, words, around, meaning, axis, comments, implied)
        if leaf.endswith("w") and meaning.sort is Sort.QUATERNION and "[" not in leaf:
            turned = Meaning(Sort.MEASURED, (parse_unit("rad"),))
            whole = leaf.rpartition(".")[0]
            # Roll and pitch only from an IMU: robots that drive on a plane report 0 for them.
            for turn in TURNS if topic.type.endswith("/Imu") else TURNS[:1]:
                called = (turn, "angle")
                yield Candidate(topic, f"{turn}({whole})", kind, called, around, turned)
        if leaf.endswith("linear.x") and "[" not in leaf:
            value = f"hypot({leaf}, {leaf[:-1]}y)"
            level = ("speed", "ground", "horizontal")
            yield Candidate(topic, value, kind, level, around, meaning)
    yield from _of_keys(topic, named, around)


def _of_keys(topic: Topic, names: TopicNames, around: tuple[str, ...]) -> Iterator[Candidate]:
    """Yield the candidates of values with a key, which are texts that may hold numbers."""
    for path, value in names.entries.items():
        own = tuple(words_of(" ".join(re.findall(r"\[([^\[\]]+)\]", path))))
        if number(value) is None:
            yield Candidate(topic, path, Kind.LABEL, own, around, UNKNOWN)
        else:
            yield Candidate(topic, f"number({path})", Kind.REAL, own, around, UNKNOWN)


def _places(
    leaf: str, meaning: Meaning, named: TopicNames, with_names: Mapping[str, str]
) -> Iterator[tuple[str, list[str], str]]:
    """Yield the values of a field with their words and axis.

    An array gives its elements along axes, the minimum of distances, and its named elements.
    """
    words = [*words_of(leaf), *(one for word in meaning.words for one in words_of(word))]
    if "[" not in leaf:
        last = words_of(leaf.rpartition(".")[2])[-1:]
        yield leaf, words, last[0] if last and last[0] in AXES else ""
        return
    array = leaf.removesuffix("[]")
    if "[" in array:
        return
    if "xyz" in meaning.words and meaning.sort is not Sort.QUATERNION:
        plain = [word for word in words if word != "xyz"]
        for place, axis in enumerate(AXES):
            yield f"{array}[{place}]", [*plain, axis], axis
    elif "distance" in words and meaning.sort is Sort.MEASURED:
        yield f"min({array})", ["nearest", *words], ""
    for name in named.joints.get(with_names.get(array, ""), ()):
        yield f"{array}[{name}]", [*words, *words_of(name)], ""


def _implied(value: str, own: Iterable[str], meaning: Meaning, axis: str) -> tuple[str, ...]:
    if "position" in own and value.endswith("]"):
        return ("extension", "angle")
    dimensions = [unit.dimension for unit in meaning.units[:1]]
    found = (own for unit, own in _ALONG.items() if parse_unit(unit).dimension in dimensions)
    return next(found, {}).get(axis, ())


def events_of(topics: Mapping[str, Topic]) -> Iterator[Candidate]:
    """Yield the candidates for events: the only truth value of a topic, or else each message."""
    for topic in topics.values():
        if topic.fault:
            continue
        flags = [
            leaf
            for leaf, kind in topic.leaves.items()
            if kind is Kind.BOOL or leaf in topic.doubtful
        ]
        around, meaning = tuple(words_of(topic.name)), Meaning(Sort.CODE)
        if len(flags) == 1 and "[" not in flags[0]:
            own = tuple(words_of(flags[0]))
            yield Candidate(topic, flags[0], Kind.BOOL, own, around, meaning)
        else:
            yield Candidate(topic, "", None, (), around, meaning)


def foreign_words(candidate: Candidate) -> list[str]:
    """The meaningful words of a candidate's topic and value, not those of its meaning."""
    field = words_of(candidate.value)
    written = [*words_of(candidate.topic.name), *field]
    plain = {*EMPTY, *AXES, "hypot", candidate.axis}
    if {*field} <= PLACES:
        plain -= PLACES  # the field has no other word, so these are its meaning
    return [word for word in dict.fromkeys(written) if word not in plain]


def modifiers_of(candidate: Candidate) -> set[str]:
    """The words that turn a candidate into another quantity, such as an error or a limit.

    These are words of the field in `MODIFIERS`, of a comment in `OF_COMMENTS`, and of the topic in
    `OF_TOPICS`, or in `MODIFIERS` if the message is just a number (`data`).
    """
    is_alone = candidate.meaning.sort is Sort.OPEN and candidate.value == "data"
    words = words_of(candidate.topic.name)
    found = {word for word in words if word in (MODIFIERS if is_alone else OF_TOPICS)}
    found |= {word for word in candidate.comment_words if word in OF_COMMENTS}
    return found | {word for word in candidate.own if word in MODIFIERS}


_FIRST = 3  # distinct values that are shown


class Range(Struct):
    """The range of the values seen."""

    count: int = 0  # messages with a known value
    first: list[Any] = field(default_factory=list)  # the first distinct values
    low: float | None = None  # the least number; `None` if there was none
    high: float | None = None  # the greatest number

    def add(self, value: Any) -> None:
        """Take the value of a message; `None` and NaN are ignored."""
        if value is None or value != value:
            return
        self.count += 1
        if value not in self.first and len(self.first) < _FIRST:
            self.first.append(value)
        if isinstance(value, int | float) and not isinstance(value, bool):
            self.low = value if self.low is None else min(self.low, value)
            self.high = value if self.high is None else max(self.high, value)

    @property
    def is_constant(self) -> bool:
        """Whether all values were the same number."""
        return self.low is not None and self.low == self.high

    def __str__(self) -> str:
        if not self.count:
            return "no value"
        first = ", ".join(_shown(value) for value in self.first)
        if self.low is None or self.high is None:
            return f"first {first}"
        if self.low == self.high:
            return f"always {_shown(self.low)}"
        return f"{_shown(self.low)} … {_shown(self.high)}, first {first}"


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value + 0:.6g}"  # without the sign of -0
    return shorten(str(value))


def ranges_of(
    source: MessageFile, candidates: Iterable[Candidate]
) -> Mapping[tuple[str, str], Range]:
    """By key of a candidate, the range of its values in the first messages of a recording."""
    ranges: dict[tuple[str, str], Range] = {}
    readers: dict[str, list[tuple[Range, Get]]] = defaultdict(list)
    for candidate in candidates:
        if candidate.value and candidate.key not in ranges:
            kept = ranges[candidate.key] = Range()
            readers[candidate.topic.name].append((kept, getter(term_of(candidate.value))))
    with suppress(TraceError):
        for number, (topic, _, content) in enumerate(source.read(set(readers))):
            if number == MOST:
                break
            for kept, read in readers[topic]:
                with suppress(KeyError, TraceError):
                    kept.add(plain(read(content)))
    return ranges
