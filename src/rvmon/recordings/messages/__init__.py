"""Recordings of messages, from ROS bags to CAN logs: topics, and the interface of all formats."""

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
    """A topic of a recording, and the fields of its messages."""

    name: str
    type: str  # of its messages
    # leaf fields (those that are no messages themselves): kind by path, in which an array is
    # `name[]`; empty if not known
    leaves: Mapping[str, Kind]
    fault: str = ""  # why its messages cannot be read; "" if they can
    # fields that are messages themselves: type by path, as far as the definition names it
    messages: Mapping[str, str] = field(default_factory=dict)
    # the paths of leaf fields without a known kind, as no value of them was seen
    doubtful: frozenset[str] = frozenset()
    # units that the recording states, by path
    units: Mapping[str, str] = field(default_factory=dict)
    # comments on fields in the definition, by path
    comments: Mapping[str, str] = field(default_factory=dict)


Message = tuple[str, int, Any]
"""A message: topic, ticks of its log stamp, content (an object with attributes, or a mapping)."""


class Messages(ABC):
    """An open recording of messages."""

    topics: Mapping[str, Topic]  # by name
    end: int | None = None  # the tick at which the recording ends; `None` if not known
    count: int = 0  # the number of all messages; 0 if not known
    outages: Sequence[Outage] = ()  # its outages, in order; their `names` are topics

    @abstractmethod
    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the messages of these topics in order of log stamps.

        Raises:
            TraceError: a message cannot be read.
        """

    def close(self) -> None:  # noqa: B027 - most formats leave nothing open
        """Close the files."""


def by_name(topics: Iterable[Topic]) -> dict[str, Topic]:
    """Topics by name; a topic with messages of two types gets a fault."""
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
    """Turn every exception of a library into a `TraceError`, as a damaged file may raise any.

    Args:
        form: the name of the format, for the message.
        fix: the advice in the message.
        fixes: more specific advice, by a text that the exception contains.
    """
    try:
        yield
    except (RvmonError, MemoryError, GeneratorExit):
        raise
    except Exception as error:  # noqa: BLE001 - each library has its own exceptions
        remedy = next((own for sign, own in (fixes or {}).items() if sign in str(error)), fix)
        raise TraceError(f"cannot be read as {form} ({first_line(error)}): {remedy}") from None
