"""What nodes of ROS 1 and ROS 2 have in common."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec

from rvmon.adapters.messages import MessageFeed
from rvmon.live.clock import SimulatedClock
from rvmon.live.robot import Judgement
from rvmon.readers.messages.topic import Topic
from rvmon.trace.time import TICKS_PER_SECOND

CLOCK = "/clock"


class RosSource:
    """A node that offers what the topics of a feed say, from `with` on.

    Args:
        feed: gets the messages.
        clock: follows `/clock`; `None`: the clock of the driver runs by itself.
        verdicts: the topic on which verdicts are published, as JSON in `std_msgs/String`; `None`:
            none are.
    """

    def __init__(
        self,
        feed: MessageFeed,
        *,
        clock: SimulatedClock | None = None,
        verdicts: str | None = None,
    ) -> None:
        self._feed = feed
        self._clock = clock
        self._verdicts = verdicts
        self._send: Callable[[str], object] | None = None

    def _topics(self) -> list[str]:
        return [*self._feed.topics(), *([CLOCK] if self._clock is not None else [])]

    def _hear(self, topic: Topic, content: Any) -> None:
        if topic.name == CLOCK and self._clock is not None:
            stamp = content.clock
            self._clock.set_ns(stamp.sec * TICKS_PER_SECOND + stamp.nanosec)
        else:
            self._feed.take(topic, content)

    def publish(self, judgement: Judgement) -> None:
        """Publish a verdict: to be called by a driver, as its `on_judged`."""
        if self._send is not None:
            self._send(msgspec.json.encode(judgement.to_dict()).decode())
