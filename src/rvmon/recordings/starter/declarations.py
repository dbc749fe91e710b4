"""Possible declarations of the names and topics of a recording, by the values seen."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from msgspec.structs import replace

from rvmon.errors import TraceError
from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.field_meanings import Sort, meaning_of
from rvmon.recordings.messages.fields import Get, arrays_with_names, field_of, getter
from rvmon.recordings.messages.file import MessageFile, TopicNames, names_in
from rvmon.recordings.messages.topic_matching import dotted
from rvmon.recordings.starter.observed_values import Shape, Shapes
from rvmon.recordings.values import FALSE_WORDS, TRUE_WORDS
from rvmon.trace.schema import Kind

MOST_LABELS = 16  # a text column with more values than this is left out

_NUMBER = re.compile(
    r"[+-]?(?:\d++\.?+\d*+|\.\d++)(?:e[+-]?\d++)?+|[+-]?(?:nan|inf(?:inity)?)", re.IGNORECASE
)
_WHOLE = re.compile(r"[+-]?\d{1,18}", re.ASCII)


class SeenValues:
    """The values seen of one name; a CSV cell 0 or 1 is a bit, a number or a truth value."""

    def __init__(self) -> None:
        self.kinds: set[Kind] = set()
        self.bits = False
        self.labels: dict[str, None] = {}
        self.fields: dict[str, SeenValues] = {}
        self.payloads = 0
        self.other = False

    def add(self, value: object) -> None:
        """Take a JSON value that is neither null nor an object."""
        match value:
            case bool():
                self.kinds.add(Kind.BOOL)
            case int() if abs(value) < 1 << 63:
                self.kinds.add(Kind.INT)
            case int() | float():
                self.kinds.add(Kind.REAL)
            case str():
                self.kinds.add(Kind.LABEL)
                self._label(value)
            case _:
                self.other = True

    def add_texts(self, cells: Iterable[str]) -> None:
        """Take cells of CSV; empty cells are ignored."""
        for cell in filter(None, cells):
            self._add_text(cell)

    def _add_text(self, cell: str) -> None:
        if cell in TRUE_WORDS or cell in FALSE_WORDS:
            if cell in "01":
                self.bits = True
            else:
                self.kinds.add(Kind.BOOL)
        elif _WHOLE.fullmatch(cell):
            self.kinds.add(Kind.INT)
        elif _NUMBER.fullmatch(cell):
            self.kinds.add(Kind.REAL)
        else:
            self.kinds.add(Kind.LABEL)
        self._label(cell)

    def _label(self, text: str) -> None:
        if len(self.labels) <= MOST_LABELS:
            self.labels[text] = None

    def add_payload(self, payload: Mapping[str, object]) -> None:
        """Take a JSON object, the payload of an event."""
        self.payloads += 1
        for key, value in payload.items():
            if value is not None:
                self.fields.setdefault(key, SeenValues()).add(value)


def shapes_seen(seen: Mapping[str, SeenValues]) -> Shapes:
    """The possible declarations of names, by the values seen."""
    declared: dict[str, Shape] = {}
    left_out: dict[str, str] = {}
    for name, entry in seen.items():
        if not name.strip():
            continue  # the index of a data frame
        shape = _shape(entry)
        if "`" in name or not name.isprintable():
            left_out[name] = "its name cannot be written"
        elif isinstance(shape, str):
            left_out[name] = shape
        else:
            declared[name] = shape
    return Shapes(declared, left_out)


def _shape(seen: SeenValues) -> Shape | str:
    """The possible declaration of a name, or the reason why there is none.

    Values of different kinds are a reason: a signal has one kind, so that the specification would
    compile, but each sample of the rarer kind would be an error.
    """
    if seen.payloads:
        if seen.kinds - {Kind.BOOL} or seen.other:
            return "objects and other values"
        kinds = {name: _shape(entry) for name, entry in seen.fields.items()}
        return Shape(
            None,
            fields={
                name: shape.kind
                for name, shape in kinds.items()
                if isinstance(shape, Shape) and shape.kind not in (None, Kind.LABEL)
                if name.isidentifier()
            },
        )
    if seen.other:
        return "lists"
    if not seen.kinds:
        return Shape(Kind.BOOL) if seen.bits else "no value in the recording"
    if seen.kinds == {Kind.BOOL}:
        return Shape(Kind.BOOL)
    if seen.kinds <= {Kind.INT, Kind.REAL}:
        return Shape(Kind.REAL if Kind.REAL in seen.kinds else Kind.INT)
    if seen.kinds != {Kind.LABEL} or seen.bits:  # 0 and 1 among text may be labels or truth values
        return "numbers and text"
    if len(seen.labels) > MOST_LABELS:
        return f"text with more than {MOST_LABELS} values"
    if any("`" in label or not label.strip() or not label.isprintable() for label in seen.labels):
        return "text that cannot be written as labels"
    return Shape(Kind.LABEL, labels=tuple(seen.labels))


_ARRAY = "an array: bind an element, or `min` of all"
_QUATERNION = "a part of a quaternion: bind `yaw` of it"
_ODD = "a covariance, or the like"


def message_shapes(source: MessageFile) -> Shapes:
    """The possible declarations of topics, their fields and the named elements of their arrays."""
    looked = names_in(source)
    declared: dict[str, Shape] = {}
    texts: dict[str, tuple[str, str]] = {}
    left_out: dict[str, str] = {}
    faults = {topic.name: _fault(topic, source) for topic in source.topics.values()}
    for topic in source.topics.values():
        name = dotted(topic.name)
        leaves = {leaf: kind for leaf, kind in topic.leaves.items() if leaf[:7] != "header."}
        if faults[topic.name]:
            left_out[name] = faults[topic.name]
            continue
        if not leaves:
            declared[name] = Shape(None, source=topic.name)
        plain = [leaf for leaf in leaves if "[" not in leaf]
        for leaf, kind in leaves.items():
            full = name if len(plain) == 1 and plain[0] == leaf else f"{name}.{leaf}"
            why = _reason(leaf, topic)
            if leaf.startswith("stamp."):
                continue
            if why:
                left_out[full] = why
            elif kind is Kind.LABEL:
                texts[full] = topic.name, leaf
            else:
                is_part = len(leaves) > 1
                unit = _unit(leaf, topic)
                declared[full] = Shape(kind, unit=unit, source=topic.name, is_part=is_part)
        for array, element, shape in _elements(topic, looked[topic.name]):
            left_out.pop(f"{name}.{array}[]", None)
            if re.fullmatch(r"\w+", element):
                declared[f"{name}.{array}.{element}"] = shape
            else:
                left_out[f"{name}.{array}[{element}]"] = "its name is not a word: bind it"
    seen = _texts_seen(source, texts)
    found = shapes_seen(seen)
    for full, shape in found.declared.items():
        declared[full] = replace(shape, source=texts[full][0])
    for topic in source.topics.values():  # a topic without a declared field becomes an event
        sources = {shape.source for shape in declared.values()}
        if not faults[topic.name] and topic.name not in sources:
            declared[dotted(topic.name)] = Shape(None, source=topic.name)
    left_out.update(found.left_out)
    return Shapes(declared, {one: why for one, why in left_out.items() if one not in declared})


def _fault(topic: Topic, source: MessageFile) -> str:
    """Why the first message of a topic cannot be read; "" if it can."""
    if topic.fault:
        return topic.fault
    try:
        next(source.read({topic.name}), None)
    except TraceError as error:
        return str(error)
    return ""


def _reason(leaf: str, topic: Topic) -> str:
    sort = meaning_of(leaf, topic).sort
    if sort is Sort.ODD or "covariance" in leaf:
        return _ODD
    if "[" in leaf:
        return _ARRAY
    if field_of(leaf) is None:
        return "its name is not a word"
    return _QUATERNION if sort is Sort.QUATERNION else ""


def _unit(leaf: str, topic: Topic) -> str:
    meaning = meaning_of(leaf, topic)
    is_clear = len(meaning.units) == 1 and not meaning.is_scaled
    return meaning.units[0].symbol if is_clear and topic.leaves[leaf] is Kind.REAL else ""


def _elements(topic: Topic, looked: TopicNames) -> Iterator[tuple[str, str, Shape]]:
    """Yield array, name and shape of the named elements of arrays, such as joint positions."""
    for array, names in arrays_with_names(topic).items():
        shape = Shape(topic.leaves[f"{array}[]"], unit=_unit(f"{array}[]", topic))
        for element in looked.joints.get(names, ()):
            if not element.isdigit():
                yield array, element, replace(shape, source=topic.name)


def _texts_seen(source: MessageFile, texts: Mapping[str, tuple[str, str]]) -> dict[str, SeenValues]:
    """The texts seen, by name; `texts`: the topic and field of each name."""
    seen = {name: SeenValues() for name in texts}
    reading: dict[str, list[tuple[SeenValues, Get]]] = {}
    for name, (topic, leaf) in texts.items():
        if (field := field_of(leaf)) is not None:
            reading.setdefault(topic, []).append((seen[name], getter(field)))
    for topic, _, content in source.read(reading) if reading else ():
        for entry, get in reading[topic]:
            try:
                value = get(content)
            except KeyError:
                continue
            except TraceError:
                entry.other = True
                continue
            if isinstance(value, str):
                entry.add(value)
    return seen
