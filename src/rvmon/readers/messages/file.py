"""A recording of messages on disk."""

from __future__ import annotations

import weakref
from collections.abc import Collection, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from rvmon.errors import TraceError
from rvmon.readers.messages.match import matched
from rvmon.readers.messages.rows import message_rows
from rvmon.readers.messages.skew import Skew
from rvmon.readers.messages.topic import Message, Messages
from rvmon.readers.places import local_path
from rvmon.readers.rows import Row
from rvmon.trace.binding import Clock
from rvmon.trace.schema import Schema


def open_messages(path: Path, form: str, schema: Schema) -> Messages:
    """Open a recording.

    Raises:
        RvmonError: what reads it is not installed.
        TraceError: it cannot be read.
        OSError: it cannot be opened.
    """
    with _sizes():
        if form == "mcap":
            from rvmon.readers.messages.mcap import mcap_messages

            return mcap_messages(path, schema.binding.definitions)
        if form == "tables":
            from rvmon.readers.messages.tables import TableMessages

            return TableMessages(path)
        from rvmon.readers.messages.ros import BagMessages

        return BagMessages(path, form, schema.binding.definitions)


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

    Args:
        path: of it.
        form: one of `MESSAGE_FORMS`.
        schema: the declared names, and how the recording gives them.

    Attributes:
        topics: by name.
        names: declared names that have a topic.
        unread: the topics and fields that feed nothing.
        end: the last instant of the recording; `None` where another clock counts.
        count: of its messages; 0 if nobody knows.
        skew: of the clocks of those who sent what was read last.

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
        found = matched(schema, source.topics)
        self._bounds = found.bounds
        self.unread = found.unread
        self.count = source.count
        self.end = source.end
        clocks = {bound.clock or schema.binding.clock for bound in self._bounds.values()}
        if Clock.HEADER in clocks:
            self.end = None
        self.names = frozenset(self._bounds)
        self.skew = Skew()

    def _opened(self) -> Messages:
        path, form = self._place
        return open_messages(local_path(path), form, self._schema)

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
