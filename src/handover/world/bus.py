"""The message bus, and the schedule: a queue of calls at integer nanoseconds."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Mapping
from typing import Any

from handover.robot.ports import Message, Value
from handover.world.parameters import LATCH_LINGER_S, NS


class Schedule:
    """A queue of calls in order of time; calls at one instant keep the order of being added."""

    def __init__(self) -> None:
        self.now_ns = 0  # the instant of the current call
        self._queue: list[tuple[int, int, Callable[[], None]]] = []
        self._entered = 0

    def at(self, t_ns: int, call: Callable[[], None]) -> None:
        """Schedule a call at an instant, now or later."""
        heapq.heappush(self._queue, (t_ns, self._entered, call))
        self._entered += 1

    def next_ns(self) -> int | None:
        """The instant of the next call, or `None` if there is none."""
        return self._queue[0][0] if self._queue else None

    def run_next(self) -> None:
        """Advance time to the next call and make it."""
        self.now_ns, _, call = heapq.heappop(self._queue)
        call()


Tap = Callable[[str, Value], None]

_LINGER_NS = round(LATCH_LINGER_S * NS)


class Bus:
    """Carries messages between nodes, and passes each message to the taps when it is published."""

    def __init__(self, schedule: Schedule) -> None:
        self.schedule = schedule
        self._latched: dict[str, tuple[Node, Message]] = {}
        self._taps: list[Tap] = []

    def tap(self, tap: Tap) -> None:
        """Call `tap(topic, value)` for every message from now on."""
        self._taps.append(tap)

    def publish(self, publisher: Node, topic: str, value: Value, *, latched: bool) -> None:
        """Publish a message; a latched one replaces the topic's latched message."""
        if latched:
            stamp = self.schedule.now_ns / NS
            self._latched[topic] = (publisher, Message(value, stamp))
        for tap in self._taps:
            tap(topic, value)

    def latched(self, topic: str) -> Message | None:
        """The topic's latched message, while its publisher is still available."""
        entry = self._latched.get(topic)
        if entry is None:
            return None
        publisher, message = entry
        ended_ns = publisher.ended_ns
        is_gone = ended_ns is not None and self.schedule.now_ns > ended_ns + _LINGER_NS
        return None if is_gone else message


class Node:
    """A process on the bus, which publishes, subscribes, reads, and ends."""

    def __init__(self, bus: Bus, params: Mapping[str, Any], poll_growth_s: float) -> None:
        self.params = params  # its parameters from the launch file
        self._bus = bus
        self._growth_s = poll_growth_s
        self._subscriptions: dict[str, int] = {}
        self._delay_s = 0.0
        self.ended_ns: int | None = None  # when the process ended

    def now(self) -> float:
        """Seconds since the start."""
        return self._bus.schedule.now_ns / NS

    def publish(self, topic: str, value: Value = None, *, latched: bool = False) -> None:
        """Publish a message; a latched one can be read as long as this node lives."""
        self._bus.publish(self, topic, value, latched=latched)

    def subscribe(self, topic: str) -> None:
        """Subscribe once more; each further subscription slows down all reads of the topic."""
        self._subscriptions[topic] = self._subscriptions.get(topic, 0) + 1

    def receive(self, topic: str) -> Message | None:
        """The topic's latched message, if this node has subscribed and the publisher lives."""
        count = self._subscriptions.get(topic, 0)
        if count == 0:
            return None
        self._delay_s += (count - 1) * self._growth_s
        return self._bus.latched(topic)

    def take_delay_s(self) -> float:
        """The seconds by which reads have slowed down this node since the last call."""
        delay, self._delay_s = self._delay_s, 0.0
        return delay

    def end(self) -> None:
        """End the process; its latched messages disappear after `LATCH_LINGER_S`."""
        self.ended_ns = self._bus.schedule.now_ns
