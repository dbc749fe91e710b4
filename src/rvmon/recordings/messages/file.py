"""A recording of messages on disk."""

from __future__ import annotations

import weakref
from collections.abc import Collection, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path

from rvmon.errors import TraceError
from rvmon.recordings.messages import Message, Messages
from rvmon.recordings.messages.rows import Skew, message_rows
from rvmon.recordings.messages.topic_matching import matched
from rvmon.recordings.messages.transforms import WithTransforms, pairs_asked, sends_transforms
from rvmon.recordings.places import local_path
from rvmon.recordings.rows import Row
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Clock, Schema


def open_messages(path: Path, form: str, schema: Schema) -> Messages:
    """Open a recording.

    Raises:
        RvmonError: what reads it is not installed.
        TraceError: it cannot be read.
        OSError: it cannot be opened.
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
            case "mdf":
                from rvmon.recordings.messages.mdf import mdf_messages

                if (measured := mdf_messages(path)) is not None:
                    return measured
                from rvmon.recordings.messages.can import FrameMessages

                return FrameMessages(path, definitions)
            case "can":
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
    """Messages take little memory, unless what the file says of their sizes is wrong."""
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
    """A recording of messages, looked at.

    Attributes:
        topics: by name.
        names: declared names that have a topic.
        unread: the topics and fields that feed nothing.
        end: the last instant of the recording; `None` where another clock counts.
        count: of its messages; 0 if nobody knows.
        skew: of the clocks of those who sent what was read last.
        outages: its outages, in order.

    Raises:
        RvmonError: what reads it is not installed.
        TraceError: it cannot be read, or does not fit the binding.
        OSError: it cannot be opened.
    """

    def __init__(self, path: str, form: str, schema: Schema) -> None:
        self._place = path, form
        self._schema = schema
        source = self._opened()
        # To open it anew takes as long as to read a few hundred messages.
        self._ready = [source]
        weakref.finalize(self, _close, self._ready)
        self.topics = source.topics
        self._bounds, self.unread = matched(schema, source.topics)
        self.count = source.count
        self.end = source.end
        clocks = {bound.clock or schema.binding.clock for bound in self._bounds.values()}
        if Clock.HEADER in clocks:
            self.end = None
        self.names = frozenset(self._bounds)
        self.skew = Skew()
        self.outages = tuple(self._of_names(source.outages))
        if source.outages and Clock.HEADER in clocks:
            raise TraceError(
                f"{source.outages[0].why}; its instant by the stamps of headers is not known: "
                'evaluate it with `clock = "log"`'
            )

    def _of_names(self, outages: Sequence[Outage]) -> Iterator[Outage]:
        """Outages of topics as those of the names that they feed."""
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
        pairs = pairs_asked([*bound, *schema.columns.values(), *schema.signals])
        if pairs and sends_transforms(source.topics):
            return WithTransforms(source, pairs)
        return source

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """The messages of these topics, as they were recorded.

        Raises:
            TraceError: one cannot be read.
        """
        with closing(self._opened()) as source, _sizes():
            yield from source.read(topics)

    def rows(self, *, ordered: bool) -> Iterator[Row]:
        """The rows of its messages; see `message_rows`."""
        if not self._bounds:
            raise TraceError("holds no topic that is read")
        with closing(self._ready.pop() if self._ready else self._opened()) as source, _sizes():
            self.skew = skew = Skew()
            yield from message_rows(source, self._bounds, self._schema, skew, ordered=ordered)
