"""Files of messages: opens them by format, and finds names (frames, array elements) in them."""

from __future__ import annotations

import weakref
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from msgspec import Struct, field

from rvmon.errors import TraceError
from rvmon.recordings.messages import Message, Messages
from rvmon.recordings.messages.fields import arrays_of_names, field_of, getter, part_of
from rvmon.recordings.messages.rows import Skew, message_rows
from rvmon.recordings.messages.topic_matching import matched
from rvmon.recordings.messages.transforms import WithTransforms, requested_pairs, sends_transforms
from rvmon.recordings.places import local_path
from rvmon.recordings.rows import Row
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Clock, Schema
from rvmon.trace.time import whole_ticks


def open_messages(path: Path, form: str, schema: Schema) -> Messages:
    """Open a recording of messages.

    Raises:
        RvmonError: the package that reads the format is not installed.
        TraceError: the file cannot be read.
        OSError: the file cannot be opened.
    """
    definitions = schema.binding.definitions
    with _sizes():
        match form:
            case "mcap":
                from rvmon.recordings.messages.mcap import mcap_messages

                return mcap_messages(path, definitions)
            case "tables":
                from rvmon.recordings.messages.table_folder import TableMessages

                return TableMessages(path)
            case "ulog":
                from rvmon.recordings.messages.ulog import ulog_messages

                return ulog_messages(path)
            case "dataflash":
                from rvmon.recordings.messages.dataflash import dataflash_messages

                return dataflash_messages(path)
            case "tlog":
                from rvmon.recordings.messages.tlog import TelemetryMessages

                return TelemetryMessages(path)
            case "mdf" | "can":
                if form == "mdf":
                    from rvmon.recordings.messages.mdf import mdf_messages

                    if (measured := mdf_messages(path)) is not None:
                        return measured
                from rvmon.recordings.messages.can import FrameMessages

                return FrameMessages(path, definitions)
            case "hdf5" | "mat":
                from rvmon.recordings.messages.hdf5 import array_messages

                return array_messages(path, schema.stamps)
            case _:
                from rvmon.recordings.messages.ros import BagMessages

                return BagMessages(path, form, definitions)


@contextmanager
def _sizes() -> Iterator[None]:
    """Report a `MemoryError` as a `TraceError`: messages are small, unless a size is damaged."""
    try:
        yield
    except MemoryError:
        raise TraceError(
            "cannot be read: a size in it is beyond the memory: copy it again if it is damaged, "
            "or raise --max-memory"
        ) from None


def _close(ready: list[Messages]) -> None:
    for source in ready:
        source.close()


class MessageFile:
    """A recording of messages on disk, with its topics matched to the schema."""

    def __init__(self, path: str, form: str, schema: Schema) -> None:
        self._place = path, form
        self._schema = schema
        source = self._opened()
        # Kept open for the first reading: opening it again takes as long as a few hundred messages.
        self._ready = [source]
        weakref.finalize(self, _close, self._ready)
        self.topics = source.topics  # by name
        # `unread`: the topics and fields that feed no declared name
        self._bounds, self.unread = matched(schema, source.topics)
        self.count = source.count  # of all messages; 0 if not known
        # the last instant by log stamps, ticks; `None` if not known, or if header stamps are used
        self.end = None if source.end is None else whole_ticks(source.end)
        clocks = {bound.clock or schema.binding.clock for bound in self._bounds.values()}
        if Clock.HEADER in clocks:
            self.end = None
        self.names = frozenset(self._bounds)  # the declared names that have a topic
        self.skew = Skew()  # differences between header and log stamps in the last reading
        self.outages = tuple(self._of_names(source.outages))  # in order; `names` are declared names
        if source.outages and Clock.HEADER in clocks:
            raise TraceError(
                f"{source.outages[0].why}; its instant by the stamps of headers is not known: "
                'evaluate it with `clock = "log"`'
            )

    def _of_names(self, outages: Sequence[Outage]) -> Iterator[Outage]:
        """Turn outages of topics into outages of the declared names that they feed."""
        for outage in outages:
            if outage.names is None:
                yield outage
            elif fed := {name for name, own in self._bounds.items() if own.topic in outage.names}:
                yield replace(outage, names=frozenset(fed))

    def _opened(self) -> Messages:
        path, form = self._place
        source = open_messages(local_path(path), form, self._schema)
        schema = self._schema
        bound = [bound.topic for bound in schema.binding.bounds.values()]
        pairs = requested_pairs([*bound, *schema.columns.values(), *schema.signals])
        if pairs and sends_transforms(source.topics):
            return WithTransforms(source, pairs)
        return source

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the messages of these topics in order of log stamps."""
        with closing(self._opened()) as source, _sizes():
            yield from source.read(topics)

    def rows(self, *, ordered: bool) -> Iterator[Row]:
        """Yield the messages as rows; see `message_rows`.

        Raises:
            TraceError: no topic feeds a declared name, or a message cannot be read.
        """
        if not self._bounds:
            raise TraceError("holds no topic that is read")
        with closing(self._ready.pop() if self._ready else self._opened()) as source, _sizes():
            self.skew = skew = Skew()
            yield from message_rows(source, self._bounds, self._schema, skew, ordered=ordered)


MOST = 50_000  # the most messages that are examined

_FIRST = 3
_FIRST_OF_MANY = 300
"""Messages of a topic that are searched for names; more if it has keys, as many nodes share it."""

_FRAMES = ("header.frame_id", "child_frame_id")


class TopicNames(Struct, frozen=True):
    """The names found in the first messages of a topic."""

    frames: frozenset[str] = frozenset()  # the frames in headers
    # by the path of an array of names, the names in it
    joints: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    # the first value of each key, by its path: `status[motor].values[Load].value`
    entries: Mapping[str, str] = field(default_factory=dict)


def names_in(source: MessageFile) -> Mapping[str, TopicNames]:
    """Find the names in the first messages of each topic: frames, array elements, keys."""
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
    with suppress(TraceError):  # reading the whole recording reports the error
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
    return {
        topic: TopicNames(
            frozenset(name for leaf in _FRAMES for name in found[topic].get(leaf, ()) if name),
            {leaf: tuple(own) for leaf, own in found[topic].items() if leaf not in _FRAMES},
            entries[topic],
        )
        for topic in wanted
    }


def _entries(steps: Sequence[str], content: Any) -> Iterator[tuple[str, str]]:
    """Yield the path and value of each key, also in arrays inside of named elements.

    `steps`: the path of the keys, split at `[].`.
    """
    found, is_last = part_of(content, steps[0]), len(steps) == 2
    for element in found if isinstance(found, list | tuple) else ():
        [name] = _texts("key" if is_last else "name", element) or [""]
        if not name or name != name.strip() or not set(name).isdisjoint("[]`"):
            continue
        if is_last:
            for value in _texts("value", element):
                yield f"{steps[0]}[{name}].value", value
        else:
            inner = _entries(steps[1:], element)
            yield from ((f"{steps[0]}[{name}].{path}", value) for path, value in inner)


def _texts(leaf: str, content: Any) -> list[str]:
    path = field_of(leaf.removesuffix("[]"))
    if path is None:
        return []
    with suppress(KeyError, TraceError):
        value = getter(path)(content)
        return [value] if isinstance(value, str) else [str(one) for one in value or ()]
    return []
