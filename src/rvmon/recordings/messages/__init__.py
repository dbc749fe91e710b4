"""Recordings of messages, from bags of ROS to logs of CAN: topics, and what all formats share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from msgspec import Struct, field

from rvmon.errors import RvmonError, TraceError
from rvmon.recordings.values import first_line
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Kind


class Topic(Struct, frozen=True):
    """A topic of a recording."""

    name: str
    type: str  # of its messages
    # the kinds of the fields that are no messages themselves, by their path, where an array is
    # `name[]`; empty if nobody knows
    leaves: Mapping[str, Kind]
    fault: str = ""  # why its messages cannot be read; empty if they can
    # the types of the fields that are messages themselves, by their path, as far as the definition
    # names them
    messages: Mapping[str, str] = field(default_factory=dict)
    # the fields whose kind is not known: nothing was seen of them
    doubtful: frozenset[str] = frozenset()
    # of the fields whose unit the recording says itself, by their path
    units: Mapping[str, str] = field(default_factory=dict)
    # of the definition on fields, by path
    comments: Mapping[str, str] = field(default_factory=dict)


Message = tuple[str, int, Any]
"""Topic, ticks at which it was recorded, content: an object with attributes, or a mapping."""


class Messages(ABC):
    """An open recording."""

    topics: Mapping[str, Topic]  # by name
    end: int | None = None  # the tick of the last message of all; `None` if nobody knows
    count: int = 0  # of all messages; 0 if nobody knows
    outages: Sequence[Outage] = ()  # its outages, in order; `names` are of topics

    @abstractmethod
    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """The messages of these topics, by time.

        Raises:
            TraceError: one cannot be read.
        """

    def close(self) -> None:  # noqa: B027 - mostly nothing is open
        """Close the files."""


def by_name(topics: Iterable[Topic]) -> dict[str, Topic]:
    """Topics by name; one that comes with two types cannot be read."""
    found: dict[str, Topic] = {}
    for topic in topics:
        known = found.setdefault(topic.name, topic)
        if known.type != topic.type:
            fault = f"it holds messages of two types, {known.type} and {topic.type}"
            found[topic.name] = Topic(topic.name, topic.type, {}, fault)
    return found


@contextmanager
def errors_as_damage(
    form: str, fix: str = "is it cut off? Copy it again", fixes: Mapping[str, str] | None = None
) -> Iterator[None]:
    """Turns whatever a library raises into an error of the file: damage shows anywhere.

    `fix` is the advice, and `fixes` the same by a word of the error that says more.
    """
    try:
        yield
    except (RvmonError, MemoryError, GeneratorExit):
        raise
    except Exception as error:  # noqa: BLE001 - each library has errors of its own
        remedy = next((own for sign, own in (fixes or {}).items() if sign in str(error)), fix)
        raise TraceError(f"cannot be read as {form} ({first_line(error)}): {remedy}") from None
