"""What the first messages of topics name: the frames, and the elements of arrays."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from rvmon.errors import TraceError
from rvmon.readers.messages.by_names import arrays_of_names
from rvmon.readers.messages.fields import field_of, getter
from rvmon.readers.messages.file import MessageFile

MOST = 50_000
"""Messages that are looked at."""

_FIRST = 3
"""Messages of each topic whose names are read."""

_FRAMES = ("header.frame_id", "child_frame_id")


@dataclass(frozen=True, slots=True)
class Looked:
    """What the first messages of a topic say of it.

    Attributes:
        frames: that their headers name.
        joints: by the path of an array of names those in it.
    """

    frames: frozenset[str] = frozenset()
    joints: Mapping[str, tuple[str, ...]] | None = None


def names_in(source: MessageFile) -> Mapping[str, Looked]:
    """What the first messages of each topic name: frames, and the elements of arrays."""
    wanted = {
        topic.name: [leaf for leaf in _FRAMES if leaf in topic.leaves] + arrays_of_names(topic)
        for topic in source.topics.values()
        if not topic.fault
    }
    reading = {topic for topic, leaves in wanted.items() if leaves}
    found: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    counts: dict[str, int] = defaultdict(int)
    with suppress(TraceError):  # what cannot be read is told by who reads it all
        for number, (topic, _, content) in enumerate(source.read(reading)):
            if number == MOST or not reading:
                break
            counts[topic] += 1
            if counts[topic] <= _FIRST:
                for leaf in wanted[topic]:
                    for name in _texts(leaf, content):
                        if name not in found[topic][leaf]:
                            found[topic][leaf].append(name)
            if counts[topic] == _FIRST:
                reading.discard(topic)
    return {topic: _named(found[topic]) for topic in wanted}


def _texts(leaf: str, content: Any) -> Iterable[str]:
    field = field_of(leaf.removesuffix("[]"))
    if field is None:
        return []
    get = getter(field, mappings=isinstance(content, Mapping))
    with suppress(KeyError, TraceError):
        value = get(content)
        return [value] if isinstance(value, str) else [str(one) for one in value or ()]
    return []


def _named(found: Mapping[str, list[str]]) -> Looked:
    frames = frozenset(name for leaf in _FRAMES for name in found.get(leaf, ()) if name)
    joints = {leaf: tuple(names) for leaf, names in found.items() if leaf not in _FRAMES}
    return Looked(frames, joints)
