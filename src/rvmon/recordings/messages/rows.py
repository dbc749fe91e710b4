"""Conversion of messages to rows of declared names, and a check of the senders' clocks."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import Any

from msgspec import Struct, field

from rvmon.errors import TraceError
from rvmon.recordings.messages import Messages, Topic
from rvmon.recordings.messages.fields import getter, stamp_getter
from rvmon.recordings.rows import Row
from rvmon.recordings.values import DESCRIPTION, as_declared, fits, plain
from rvmon.texts import shorten
from rvmon.trace.sample import Health, HealthKind, Value
from rvmon.trace.schema import Bound, Clock, Gaps, Kind, Schema, Term
from rvmon.trace.time import format_ticks, whole_ticks

_ABSENT = object()

Take = Callable[[Any, dict[str, Value]], object]
"""Adds the value that a message's content has for a name to the values of a row."""


def message_rows(
    source: Messages, bounds: Mapping[str, Bound], schema: Schema, skew: Skew, *, ordered: bool
) -> Iterator[Row]:
    """Yield a row of number, ticks and values for each message that feeds a declared name.

    A message that feeds names with different clocks gives a row for each clock. If header stamps
    are used, all rows are sorted by time in memory, unless late samples are allowed.

    Raises:
        TraceError: a message cannot be read; the error says which one, and its topic.
    """
    rows = _rows(source, bounds, schema, skew)
    clock = schema.binding.clock
    if ordered and any((bound.clock or clock) is Clock.HEADER for bound in bounds.values()):
        return iter(sorted(rows, key=lambda row: row[1]))
    return rows


def _rows(
    source: Messages, bounds: Mapping[str, Bound], schema: Schema, skew: Skew
) -> Iterator[Row]:
    readers = MessageReaders(bounds, schema)
    counts: dict[str, int] = defaultdict(int)
    number = 0
    for topic, logged, content in source.read({bound.topic for bound in bounds.values()}):
        counts[topic] += 1
        try:
            skew.note(source.topics[topic], logged, content)
            for t, values in readers.take(source.topics[topic], logged, content):
                number += 1
                yield number, t, values
        except TraceError as error:
            raise TraceError(f"message {counts[topic]} of {topic}: {error}") from None


class MessageReaders:
    """Readers of messages by topic, made when the first message of a topic comes."""

    def __init__(self, bounds: Mapping[str, Bound], schema: Schema) -> None:
        self._schema = schema
        self._by_topic: dict[str, list[tuple[str, Bound]]] = defaultdict(list)
        for name, bound in bounds.items():
            self._by_topic[bound.topic].append((name, bound))
        self._readers: dict[str, list[tuple[Callable[[Any], int] | None, list[Take]]]] = {}

    def take(
        self, topic: Topic, logged: int, content: Any
    ) -> Iterator[tuple[int, dict[str, Value]]]:
        """Yield stamp (ticks) and values of a message for each clock; `logged`: its log stamp."""
        made = self._readers.get(topic.name)
        if made is None:
            made = self._readers[topic.name] = self._make(topic)
        for stamp, takes in made:
            values: dict[str, Value] = {}
            for take in takes:
                take(content, values)
            yield whole_ticks(logged if stamp is None else stamp(content)), values

    def _make(self, topic: Topic) -> list[tuple[Callable[[Any], int] | None, list[Take]]]:
        takes: dict[Clock, list[Take]] = defaultdict(list)
        for name, bound in self._by_topic[topic.name]:
            make = _signal if name in self._schema.signals else _event
            clock = bound.clock or self._schema.binding.clock
            takes[clock].append(make(name, bound, self._schema))
        return [
            (stamp_getter(topic) if clock is Clock.HEADER else None, own)
            for clock, own in takes.items()
        ]


def _signal(name: str, bound: Bound, schema: Schema) -> Take:
    assert bound.value is not None, "a signal has a value"
    read = _reader(name, bound.value, schema.signals[name], bound.labels, schema.gaps)
    before: list[Any] = [_ABSENT]

    def take(content: Any, values: dict[str, Value]) -> None:
        value = read(content)
        if value is _ABSENT or (bound.on_change and _is_same(before[0], value)):
            return
        before[0] = values[name] = value

    return take


def _is_same(first: Any, second: Any) -> bool:
    return first is second or first == second or (first != first and second != second)


def _event(name: str, bound: Bound, schema: Schema) -> Take:
    kinds, gaps, occurs = schema.events[name], schema.gaps, None
    fields = {
        field: _reader(f"{name}.{field}", term, kinds[field], {}, gaps)
        for field, term in bound.fields.items()
    }
    if bound.value is not None:
        occurs = _reader(name, bound.value, Kind.BOOL, {}, gaps)
    before: list[Any] = [_ABSENT]

    def take(content: Any, values: dict[str, Value]) -> None:
        happened: Any = True if occurs is None else occurs(content)
        if happened is _ABSENT:
            return
        payload = {}
        if happened and fields:
            payload = {field: read(content) for field, read in fields.items()}
            payload = {field: one for field, one in payload.items() if one is not _ABSENT}
        value = payload or happened
        if bound.on_change:
            if _is_same(before[0], value):
                value = False
            else:
                before[0] = value
        values[name] = value

    return take


def _reader(
    name: str, term: Term, kind: Kind, labels: Mapping[str, str], gaps: Gaps
) -> Callable[[Any], Any]:
    """A function from a message to a value of the kind, `None` (unknown) or `_ABSENT`."""
    get = getter(term)

    def read(content: Any) -> Any:
        try:
            value = plain(get(content))
        except KeyError:
            return _ABSENT
        if gaps and gaps.holds(value):
            return _ABSENT
        if labels and value is not None:
            key = str(value)
            if key not in labels:
                raise TraceError(f"`{name}`: no label is bound to `{shorten(key)}`: add it")
            return labels[key]
        value = as_declared(value, kind)
        if not fits(value, kind):
            raise TraceError(f"`{name}`: `{shorten(str(value))}` is not {DESCRIPTION[kind]}")
        return value

    return read


AHEAD = 1_000_000
"""Ticks by which a header may be later than the log, as clocks set over a network differ by that
much."""

APART = 100_000_000  # ticks by which the least differences of two topics may differ

DRIFT = 20_000_000
"""Ticks by which the least difference may change from the first messages to the last."""

SOME = 100  # messages in a lot, of which the least difference is taken
ENOUGH = 10  # with fewer messages nothing can be said about a clock


class Differences(Struct):
    """The differences between log and header stamps of a topic's messages, in ticks."""

    stamp: Callable[[Any], int] | None  # gives the header stamp; `None`: there is no header
    count: int = 0  # of messages with a header stamp
    first: int = 0  # the log stamp of the first of these, ticks
    # the least difference in each lot of `SOME` messages, in order
    lots: list[int] = field(default_factory=list)

    def note(self, logged: int, content: Any) -> None:
        """Take a message; a header stamp of zero was not filled in, and is ignored."""
        try:
            stamp = self.stamp(content) if self.stamp is not None else 0
        except (KeyError, TypeError, ValueError, OverflowError):
            return  # where header stamps are used, reading the message reports the error
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
        """The change of the least difference from the first lot to the last; 0 for few messages."""
        if self.count < 2 * SOME:
            return 0
        is_too_short = 0 < self.count % SOME < ENOUGH  # the last lot has too few messages yet
        return self.lots[-2 if is_too_short else -1] - self.lots[0]


class Skew(Struct):
    """The differences between log and header stamps of all topics that are read.

    The sender stamps the header, the recorder the log. The difference is the sum of the transport
    delay, which is never negative, and the offset of the two clocks. Over many messages the least
    delay is small, so the least difference is close to the offset.
    """

    by_topic: dict[str, Differences] = field(default_factory=dict)

    def note(self, topic: Topic, logged: int, content: Any) -> None:
        """Take a message."""
        found = self.by_topic.get(topic.name)
        if found is None:
            stamp = None
            with suppress(TraceError):
                stamp = stamp_getter(topic)
            found = self.by_topic[topic.name] = Differences(stamp)
        if found.stamp is not None:
            found.note(logged, content)

    def doubts(self) -> list[Health]:
        """The doubts about the clocks, by topic."""
        known = {name: own for name, own in self.by_topic.items() if own.count >= ENOUGH}
        nearest = min((min(own.lots) for own in known.values()), default=0)
        doubts = []
        for name, differences in known.items():
            if remarks := _remarks(differences, nearest, len(known)):
                count, first, remark = differences.count, differences.first, "; ".join(remarks)
                doubts.append(Health(HealthKind.CLOCK, name, count, first, remark=remark))
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
