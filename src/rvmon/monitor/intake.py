"""Intake of samples: validation, merging of equal stamps, and reordering of late samples."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from heapq import heappop, heappush
from typing import Any

from msgspec import Struct

from rvmon.errors import TimeOrderError, TraceError
from rvmon.language.checked.specification import CheckedSpec, Type
from rvmon.recordings.coalesce import Conflicts, coalesce, updates_in
from rvmon.recordings.values import as_declared, plain
from rvmon.trace.sample import Sample, Scalar, Value
from rvmon.trace.schema import Kind
from rvmon.trace.time import TIME_LIMIT, format_ticks, whole_ticks

MOST_HELD = 65_536
"""The most samples held back for late ones; beyond that, the oldest are judged early."""


class Turn(Struct, frozen=True):
    """The start (`lost`) or end of an outage of names: its first or last instant `t`, ticks."""

    t: int
    names: tuple[str, ...]
    lost: bool


class Intake:
    """Holds samples back until no other can come at or before their instant (SEMANTICS 6).

    `delay` is `max delay` in ticks: how far behind the newest sample another one may come.
    """

    def __init__(self, delay: int, events: Container[str]) -> None:
        self.delay = delay
        self.events = events
        # samples before this instant are refused; all before it has been released
        self.floor = -TIME_LIMIT
        self.conflicts = Conflicts()  # signals that got two values at one instant
        self.newest: int | None = None  # the latest instant of a sample; `None` before the first
        # the number of samples judged early because too many were held, and the instant of the
        # first of them; `None` if there were none
        self.crowded: tuple[int, int] | None = None
        # A heap of (instant, is sample, order of arrival, item), so turns precede samples of the
        # same instant.
        self._held: list[tuple[int, bool, int, Mapping[str, Value] | Turn]] = []
        self._taken = 0

    def is_too_late(self, t: int) -> bool:
        """Whether a sample at `t` exceeds the allowed delay; always false without a delay."""
        return self.delay > 0 and t < self.floor

    def take(self, t: int, values: Mapping[str, Value]) -> list[Sample | Turn]:
        """Take a sample; returns the samples and turns that are complete now, in order.

        Raises:
            TimeOrderError: it comes before the floor; nothing changed.
        """
        if t < self.floor:
            raise TimeOrderError(
                f"sample at {format_ticks(t)}, but the monitor has already reached "
                f"{format_ticks(self.floor)}: sort the samples, or allow a `max delay`"
            )
        self.newest = t if self.newest is None else max(self.newest, t)
        self._hold(t, values)
        ready = self.settle(t - self.delay)
        if self.delay and len(self._held) > MOST_HELD:
            # A clock that stands still would otherwise hold back all samples for ever.
            oldest = self._held[0][0]
            count, first = self.crowded or (0, oldest)
            self.crowded = (count + 1, first)
            ready += self.settle(oldest + 1)
        return ready

    def turn(self, turns: Sequence[Turn]) -> None:
        """Take turns at or after the floor; they are released in order with the samples."""
        for turn in turns:
            self._hold(turn.t, turn)

    def _hold(self, t: int, what: Mapping[str, Value] | Turn) -> None:
        self._taken += 1
        heappush(self._held, (t, not isinstance(what, Turn), self._taken, what))

    def settle(self, t: int) -> list[Sample | Turn]:
        """Raise the floor to `t`; returns the samples and turns before it, in order."""
        self.floor = max(self.floor, t)
        ready: list[Sample | Turn] = []
        neighbours: list[Sample] = []
        while self._held and self._held[0][0] < self.floor:
            instant, _, _, what = heappop(self._held)
            if isinstance(what, Turn):
                ready += coalesce(neighbours, self.events, self.conflicts)
                ready.append(what)
                neighbours = []
            else:
                neighbours.append(Sample(instant, what))
        return [*ready, *coalesce(neighbours, self.events, self.conflicts)]

    def state(self) -> Mapping[str, Any]:
        """The state as JSON values."""
        held: list[list[Any]] = []
        turns: list[list[Any]] = []
        for t, _, place, what in self._held:
            if isinstance(what, Turn):
                turns.append([t, place, what.names, what.lost])
            else:
                held.append([t, place, dict(what)])
        return {
            "floor": self.floor, "newest": self.newest, "crowded": self.crowded,
            "conflicts": self.conflicts.seen, "held": held, "turns": turns,
        }  # fmt: skip

    def restore_state(
        self,
        state: Mapping[str, Any],
        check: Callable[[int, Any], Mapping[str, Value]],
        known: Callable[[Iterable[Any]], set[str]],
    ) -> None:
        """Restore a `state`; values of its samples and names of its turns are checked.

        Raises:
            TraceError: a sample has a name or value unknown to the specification.
        """
        self.floor, self.crowded = _integer(state["floor"]), _counted(state["crowded"])
        self.newest = None if state["newest"] is None else _integer(state["newest"])
        for name, pair in state["conflicts"].items():
            count, first = _counted(pair) or (0, 0)
            self.conflicts.add(str(name), first, count)
        for t, place, values in state["held"]:
            self._hold_restored(whole_ticks(t), place, check(whole_ticks(t), values))
        for t, place, names, lost in state["turns"]:
            turn = Turn(whole_ticks(t), tuple(known(names)), lost is True)
            self._hold_restored(turn.t, place, turn)

    def _hold_restored(self, t: int, place: Any, what: Mapping[str, Value] | Turn) -> None:
        heappush(self._held, (t, not isinstance(what, Turn), _integer(place), what))
        self._taken = max(self._taken, place)

    def close(self) -> list[Sample | Turn]:
        """Release everything held, in order: no further sample will come."""
        return self.settle(TIME_LIMIT)


def _counted(pair: Any) -> tuple[int, int] | None:
    """A pair of count and first instant from JSON; `None` stays `None`."""
    if pair is None:
        return None
    count, first = pair
    return _integer(count), whole_ticks(first)


def _integer(number: Any) -> int:
    if type(number) is not int:
        raise TypeError(f"expected a whole number, found {number!r}")
    return number


def refuse_earlier(t: int, last: int | None, reached: int | None) -> None:
    """Refuse a sample that is not later than the previous one, or that an `advance` excluded.

    Raises:
        TimeOrderError: the sample is one of these.
    """
    if last is not None and t <= last:
        raise TimeOrderError(
            f"sample at {format_ticks(t)} is not after the one at {format_ticks(last)}: "
            "merge samples with equal stamps (settle='next' does), sort samples that are out of "
            "order"
        )
    if reached is not None and t < reached:
        raise TimeOrderError(
            f"sample at {format_ticks(t)}, but advance({format_ticks(reached)}) promised that "
            "none before would come: advance later, or drop the sample"
        )


def _refused(t: int, why: str) -> TraceError:
    """The error for a sample that is not as declared."""
    return TraceError(f"sample at {format_ticks(t)}: {why}")


_TAKES: Mapping[Kind, tuple[type, ...]] = {
    Kind.BOOL: (bool,),
    Kind.INT: (int,),
    Kind.REAL: (float, int),
    Kind.LABEL: (str,),
}


class Validator:
    """Checks samples against the declarations.

    `sources` are the names that can arrive (`None`: all); `single` are the events of which only
    one payload can be judged at one instant.
    """

    def __init__(
        self, spec: CheckedSpec, sources: frozenset[str] | None, single: frozenset[str]
    ) -> None:
        self._signals = {name: signal.type for name, signal in spec.signals.items()}
        self._events = {name: event.fields for name, event in spec.events.items()}
        self._ignoring = spec.ignoring
        self._single = single
        declared = {*self._signals, *self._events}
        self._expected = frozenset(declared if sources is None else declared & sources)
        self._declared = declared

    def check(self, t: int, values: Mapping[str, Any]) -> Mapping[str, Value]:
        """The sample in plain Python values, without entries that are not updates.

        Raises:
            TraceError: a name or value is unknown to the specification; the message names it.
        """
        if not isinstance(values, Mapping):
            raise _refused(t, f"expected values by name, found {values!r}")
        checked: dict[str, Value] = {}
        for name, value in values.items():
            if name not in self._expected:
                raise _refused(t, self._unknown(name))
            type_ = self._signals.get(name)
            if type_ is None:
                checked[name] = self._occurrence(name, value, t)
            else:
                checked[name] = _scalar(value, type_, f"`{name}`", t)
        return updates_in(checked, self._ignoring)

    def _unknown(self, name: str) -> str:
        if name in self._declared:
            return f"`{name}` arrived, but it is not among the sources of this monitor"
        return f"no signal or event named `{name}`: declare it in the spec, or leave it out"

    def _occurrence(self, name: str, value: Any, t: int) -> Value:
        declared = as_declared(plain(value), Kind.BOOL)
        if declared is None or type(declared) is bool:
            return declared
        if isinstance(value, Mapping):
            return self._payload(name, value, t)
        if isinstance(value, tuple | list):
            if len(value) > 1 and name in self._single:
                why = (
                    "only `for each` can distinguish them, and not everything that reads its "
                    "fields uses it"
                )
                raise _refused(t, f"{len(value)} payloads of `{name}`: {why}")
            return tuple(self._payload(name, payload, t) for payload in value)
        expected = "True, False, None or its payload"
        raise _refused(t, f"`{name}` is an event: expected {expected}, found {value!r}")

    def _payload(self, name: str, payload: Any, t: int) -> Mapping[str, Scalar]:
        fields = self._events[name]
        if not isinstance(payload, Mapping):
            raise _refused(t, f"`{name}`: expected a payload, found {payload!r}")
        unknown = [field for field in payload if field not in fields]
        if unknown:
            known = ", ".join(fields) or "none"
            raise _refused(t, f"`{name}` has no field `{unknown[0]}`: it has {known}")
        return {
            field: _scalar(value, fields[field], f"`{name}.{field}`", t)
            for field, value in payload.items()
        }


def _scalar(value: Any, type_: Type, name: str, t: int) -> Scalar:
    kind, takes, scalar = type_.kind, _TAKES[type_.kind], value
    if type(value) not in takes:  # a NumPy scalar, an instance of a subclass, or 0 or 1 as a bool
        scalar = as_declared(plain(value), kind)
        is_number = isinstance(scalar, takes) and not isinstance(scalar, str | bool)
        scalar = scalar + 0 if is_number else scalar  # turns a subclass into the plain type
    is_taken = scalar is None or type(scalar) in takes
    if is_taken and (kind is not Kind.LABEL or scalar in (None, *type_.labels)):
        known: Scalar = scalar
        return known
    expected = {
        Kind.BOOL: "True or False",
        Kind.INT: "a whole number",
        Kind.REAL: "a number",
        Kind.LABEL: "one of " + ", ".join(type_.labels),
    }
    raise _refused(t, f"{name}: expected {expected[kind]}, found {value!r}")
