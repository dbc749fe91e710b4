"""Translation of live messages to samples, by the same rules as for recordings."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rvmon.live.clock import SimulatedClock
from rvmon.live.driver import Driver
from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.rows import MessageReaders
from rvmon.recordings.messages.topic_matching import matched
from rvmon.trace.schema import Clock, Schema
from rvmon.trace.time import TICKS_PER_SECOND, TIME_LIMIT

CLOCK = "/clock"  # the topic with the simulated time, where robots `use_sim_time`

_log = logging.getLogger("rvmon.live.input")

_NOW = 1 - TIME_LIMIT  # stands for the instant at which a message arrives


class MessageFeed:
    """Offers the values of declared names in messages, found by the binding or by topic names.

    If a message cannot be read, the names that its topic feeds are lost.

    Args:
        driver: receives the samples.
        schema: the declared names and their binding.
        robot: the name of the robot.
        clock: the driver's clock, if it is to follow `/clock`; `None` for a wall clock.
    """

    def __init__(
        self,
        driver: Driver,
        schema: Schema,
        robot: str = "",
        *,
        clock: SimulatedClock | None = None,
    ) -> None:
        # whether the time is known; only then may topics other than `/clock` be subscribed to, as
        # earlier messages could not be stamped
        self.has_time = clock is None
        self._clock = clock
        self._driver = driver
        self._schema = schema
        self._robot = robot
        self._readers: dict[str, MessageReaders] = {}
        self._fed: dict[str, tuple[str, ...]] = {}
        self._stamped: set[str] = set()
        self._began = driver.now_ns
        self._received: dict[str, int] = {}

    def topics(self) -> Iterator[str]:
        """The topics that may feed a declared name: from the binding, or suggested by the name.

        `/clock` comes first, if the driver's clock follows it.
        """
        if self._clock is not None:
            yield CLOCK
        names = (*self._schema.signals, *self._schema.events)
        yield from dict.fromkeys(topic for name in names for topic in self._topics_of(name))

    def _topics_of(self, name: str) -> Iterator[str]:
        """The topics that may feed a name: from its binding, else from prefixes of its column.

        `base.odom` may be the topic `/base/odom` or a field of `/base`.
        """
        bound = self._schema.binding.bounds.get(name)
        if bound is not None and name not in self._schema.columns:
            yield bound.topic
            return
        path = self._schema.columns.get(name, name).strip("/").replace(".", "/")
        while path:
            yield f"/{path}"
            path = path.rpartition("/")[0]

    def take(self, topic: Topic, content: Any) -> None:
        """Offer the sample of a message; `content` is an object with attributes or a mapping."""
        if topic.name == CLOCK and self._clock is not None:
            self.set_time(content.clock.sec, content.clock.nanosec)
            return
        try:
            readers = self._readers.get(topic.name) or self._reading(topic)
            for t, values in readers.take(topic, _NOW, content):
                t_ns = None if t == _NOW else t
                self._driver.offer(values, robot=self._robot, t_ns=t_ns)
                self._received[topic.name] = self._driver.now_ns if t_ns is None else t_ns
        except Exception as error:  # noqa: BLE001 - middleware swallows errors or dies of them
            self.lose(topic.name, str(error))

    @contextmanager
    def receiving(self) -> Iterator[None]:
        """Declare everything lost if the receiving loop within `with` ends by an error."""
        try:
            yield
        except Exception as error:  # noqa: BLE001 - nobody else would notice
            _log.exception("no more messages are received")
            why = f"no more messages are received ({type(error).__name__})"
            self._driver.lose(robot=self._robot, why=why)

    def set_time(self, seconds: int, nanoseconds: int) -> None:
        """Set the clock to a time received on `/clock`."""
        if self._clock is not None:
            self._clock.set_ns(seconds * TICKS_PER_SECOND + nanoseconds)
            self.has_time = True

    def _reading(self, topic: Topic) -> MessageReaders:
        self._fed.setdefault(topic.name, ())
        bounds, _ = matched(self._schema, {topic.name: topic})
        self._fed[topic.name] = tuple(bounds)
        clock = self._schema.binding.clock
        if any((bound.clock or clock) is Clock.HEADER for bound in bounds.values()):
            self._stamped.add(topic.name)
        readers = self._readers[topic.name] = MessageReaders(bounds, self._schema)
        return readers

    def lose(self, topic: str, why: str, *, before: bool = False, for_good: bool = False) -> None:
        """Report an outage of the names that a topic feeds.

        Args:
            topic: its name.
            why: the reason why a message could not be read or did not arrive.
            before: whether the outage starts at the last message that was read.
            for_good: whether it lasts until `find` is called.
        """
        _log.warning("a message of %s is rejected: %s", topic, why)
        since = self._received.get(topic, self._began) + 1
        self._driver.lose(
            self._names_of(topic),
            robot=self._robot,
            # A message with its own stamp may be older than its arrival.
            since_ns=since if before or topic in self._stamped else None,
            is_over=not for_good,
            why=f"{topic} cannot be read" if for_good else f"a message of {topic} was rejected",
        )

    def find(self, topic: str) -> None:
        """End the outage of a topic: its messages arrive again."""
        self._driver.found(self._names_of(topic), robot=self._robot)

    def _names_of(self, topic: str) -> list[str]:
        """The names of the current specification that a topic feeds or may feed."""
        declared, schema = self._driver.spec.schema, self._schema
        names = self._fed.get(topic) or [
            name for name in (*schema.signals, *schema.events) if topic in self._topics_of(name)
        ]
        return [name for name in names if name in declared.signals or name in declared.events]
