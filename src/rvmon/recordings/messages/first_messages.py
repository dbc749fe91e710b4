"""The names in the first messages of topics: frames, and elements of arrays."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from msgspec import Struct, field

from rvmon.errors import TraceError
from rvmon.recordings.messages.fields import arrays_of_names, field_of, getter, part_of
from rvmon.recordings.messages.file import MessageFile

MOST = 50_000
"""Messages that are looked at."""

_FIRST = 3
_FIRST_OF_MANY = 300
"""Messages of each topic whose names are read; many nodes say something of themselves on one."""

_FRAMES = ("header.frame_id", "child_frame_id")


class Looked(Struct, frozen=True):
    """The names in the first messages of a topic.

    Attributes:
        frames: in their headers.
        joints: by the path of an array of names those in it.
        entries: the first value of each key, by its path: `status[motor].values[Load].value`.
    """

    frames: frozenset[str] = frozenset()
    joints: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    entries: Mapping[str, str] = field(default_factory=dict)


def names_in(source: MessageFile) -> Mapping[str, Looked]:
    """The names in the first messages of each topic: frames, elements of arrays, keys."""
    wanted: dict[str, list[str]] = {}
    keys: dict[str, list[str]] = {}
    for known in source.topics.values():
        leaves = {} if known.fault else known.leaves
        keys[known.name] = [leaf for leaf in leaves if leaf.endswith("[].key")]
        wanted[known.name] = [leaf for leaf in _FRAMES if leaf in leaves] + arrays_of_names(known)
    reading = {name for name in wanted if wanted[name] or keys[name]}
    found: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    entries: dict[str, dict[str, str]] = defaultdict(dict)
    counts: dict[str, int] = defaultdict(int)
    with suppress(TraceError):  # what cannot be read is told by who reads it all
        for number, (topic, _, content) in enumerate(source.read(set(reading))):
            if number == MOST or not reading:
                break
            if topic not in reading:
                continue
            counts[topic] += 1
            for leaf in wanted[topic]:
                for name in _texts(leaf, content):
                    if name not in found[topic][leaf]:
                        found[topic][leaf].append(name)
            for leaf in keys[topic]:
                for path, value in _entries(leaf.split("[]."), content):
                    entries[topic].setdefault(path, value)
            if counts[topic] == (_FIRST_OF_MANY if keys[topic] else _FIRST):
                reading.discard(topic)
    return {topic: _named(found[topic], entries[topic]) for topic in wanted}


def _entries(steps: Sequence[str], content: Any) -> Iterator[tuple[str, str]]:
    """The path and the value of each key: of arrays in elements that have a name, too."""
    for element in _elements(steps[0], content):
        is_last = len(steps) == 2
        [name] = _texts("key" if is_last else "name", element) or [""]
        if not name or name != name.strip() or not set(name).isdisjoint("[]`"):
            continue
        if is_last:
            for value in _texts("value", element):
                yield f"{steps[0]}[{name}].value", value
        else:
            inner = _entries(steps[1:], element)
            yield from ((f"{steps[0]}[{name}].{path}", value) for path, value in inner)


def _elements(array: str, content: Any) -> Sequence[Any]:
    found = part_of(content, array)
    return found if isinstance(found, list | tuple) else ()


def _texts(leaf: str, content: Any) -> list[str]:
    path = field_of(leaf.removesuffix("[]"))
    if path is None:
        return []
    with suppress(KeyError, TraceError):
        value = getter(path)(content)
        return [value] if isinstance(value, str) else [str(one) for one in value or ()]
    return []


def _named(found: Mapping[str, list[str]], entries: Mapping[str, str]) -> Looked:
    frames = frozenset(name for leaf in _FRAMES for name in found.get(leaf, ()) if name)
    joints = {leaf: tuple(names) for leaf, names in found.items() if leaf not in _FRAMES}
    return Looked(frames, joints, entries)
