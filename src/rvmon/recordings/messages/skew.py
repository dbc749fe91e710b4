"""Do the clocks of those who sent messages agree with the one that recorded them?

A header says when its sender stamped a message, the log when it arrived: the difference is what the
message was on its way, which is never negative, and how far the two clocks are apart. The least
difference of many messages is mostly the second.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from rvmon.errors import TraceError
from rvmon.recordings.messages.fields import stamp_getter
from rvmon.recordings.messages.topic import Topic
from rvmon.trace.sample import Health, HealthKind
from rvmon.trace.time import format_ticks

AHEAD = 1_000_000
"""Ticks by which a header may be later than the log: as far as clocks that are set by a network
differ."""

APART = 100_000_000
"""Ticks by which the least differences of two topics may differ."""

DRIFT = 20_000_000
"""Ticks by which the least difference may change from the first messages to the last."""

SOME = 100
"""Messages of which the least difference is taken at the beginning and at the end."""

ENOUGH = 10
"""Messages that say something about a clock."""


@dataclass(slots=True)
class Differences:
    """The delays between the headers of a topic's messages and their recording, in ticks.

    Attributes:
        stamp: of a message; `None`: they have no header.
        count: of messages with one.
        first: the instant at which the first was recorded.
        lots: the least difference of each `SOME` messages, in order.
    """

    stamp: Callable[[Any], int] | None
    count: int = 0
    first: int = 0
    lots: list[int] = field(default_factory=list)

    def note(self, logged: int, content: Any) -> None:
        """Take a message; a header that nobody has filled in, which is zero, says nothing."""
        try:
            stamp = self.stamp(content) if self.stamp is not None else 0
        except (KeyError, TypeError, ValueError, OverflowError):
            return  # where headers count, whoever reads them says what is wrong with them
        if not stamp:
            return
        if not self.count:
            self.first = logged
        if self.count % SOME == 0:
            self.lots.append(logged - stamp)
        self.lots[-1] = min(self.lots[-1], logged - stamp)
        self.count += 1

    @property
    def change(self) -> int:
        """From the first messages to the last; 0 if they are too few to say."""
        if self.count < 2 * SOME:
            return 0
        is_begun = 0 < self.count % SOME < ENOUGH
        return self.lots[-2 if is_begun else -1] - self.lots[0]


@dataclass(slots=True)
class Skew:
    """The differences of all topics that are read."""

    by_topic: dict[str, Differences] = field(default_factory=dict)

    def note(self, topic: Topic, logged: int, content: Any) -> None:
        """Take a message."""
        found = self.by_topic.get(topic.name)
        if found is None:
            found = self.by_topic[topic.name] = Differences(_stamp_of(topic))
        if found.stamp is not None:
            found.note(logged, content)

    def doubts(self) -> list[Health]:
        """The doubts about the clocks, by topic."""
        known = {
            name: differences
            for name, differences in self.by_topic.items()
            if differences.count >= ENOUGH
        }
        nearest = min((min(differences.lots) for differences in known.values()), default=0)
        doubts = []
        for name, differences in known.items():
            if remarks := _remarks(differences, nearest, len(known)):
                remark = "; ".join(remarks)
                doubts.append(
                    Health(
                        HealthKind.CLOCK, name, differences.count, differences.first, remark=remark
                    )
                )
        return doubts


def _remarks(differences: Differences, nearest: int, topics: int) -> list[str]:
    remarks, least = [], min(differences.lots)
    if least < -AHEAD:
        remarks.append(f"headers are up to {format_ticks(-least)} later than the log")
    elif topics > 1 and least - max(nearest, 0) > APART:
        remarks.append(
            f"headers are at least {format_ticks(least)} earlier than the log, those of "
            f"another topic {format_ticks(max(nearest, 0))}"
        )
    if abs(differences.change) > DRIFT:
        away = "further from" if differences.change > 0 else "nearer to"
        remarks.append(f"headers come {format_ticks(abs(differences.change))} {away} the log")
    return [*remarks, "do the clocks agree?"] if remarks else []


def _stamp_of(topic: Topic) -> Callable[[Any], int] | None:
    try:
        return stamp_getter(topic)
    except TraceError:
        return None
