"""From samples to words: which instants are positions, and what is known at each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import dropwhile, pairwise

from rvmon.errors import TimeOrderError, TraceError
from rvmon.spec.checked.specification import CheckedSpec, Event, Signal, TimeModel
from rvmon.testing.law.kleene import Truth, disjunction, truth_of
from rvmon.testing.law.numbers import at_edge, known_scalar
from rvmon.testing.law.outage import Outage
from rvmon.testing.law.word import EventState, Letter, Occurrence, SignalState, Update, Word
from rvmon.trace.sample import Payload, Sample, Value

MOST_TICKS = 1_000_000
"""Longer traces are refused: every tick is a position here, so tests count in nanoseconds."""


def word_of(
    spec: CheckedSpec,
    samples: Sequence[Sample],
    *,
    end: int | None = None,
    advances: Sequence[int] = (),
    names: frozenset[str] | None = None,
    outages: Sequence[Outage] = (),
    next_law: bool = False,
) -> Word:
    """Lay a trace out position by position.

    Args:
        spec: gives the time model and the names.
        samples: with strictly increasing times.
        end: what `finish` was given, ticks.
        advances: what `advance` was given, ticks; the samples are taken to fit.
        names: the names that have a source; `None`: all.
        outages: what was lost, in any order.
        next_law: whether `finish(t)` is `advance(t + 1 tick)` and then the end, and numbers are
            rounded at the edge.

    Raises:
        TimeOrderError: the times do not increase.
        TraceError: the trace is too long to be laid out tick by tick, or a sample holds a name
            without a source.

    Source: SEMANTICS, sections 1, 3 (The end) and 5; decision record 1.
    """
    for earlier, later in pairwise(samples):
        if later.t <= earlier.t:
            raise TimeOrderError(f"sample at {later.t} ns after one at {earlier.t} ns")
    heard_of = [*(sample.t for sample in samples), *(outage.last for outage in outages)]
    reached = max([*advances, *heard_of, *_given(end)], default=0)
    if not heard_of:
        return Word((), None, reached)
    samples = heard(spec, samples)
    begun = samples[0].t if samples else None
    first = min([*(outage.first for outage in outages), *_given(begun)])
    # In sampled time `advance` says only what will not come; else it settles all ticks before.
    settled = [] if spec.time is TimeModel.SAMPLED else [t - 1 for t in advances]
    known_to = max([*heard_of, *settled, *_given(end)])
    if next_law:
        reached = max(reached, known_to + 1)
    if reached - first > MOST_TICKS:
        raise TraceError(
            f"the trace spans {reached - first} ns, and the oracle walks every one of them: "
            f"scale durations and times so that at most {MOST_TICKS} remain"
        )
    instants = _positions(spec, samples, outages, first, known_to)
    letters = []
    for index, instant in enumerate(instants):
        before = instants[index - 1] if index else None
        if _is_sure(spec, instant, begun, outages):
            told = _Told(spec, samples, names, outages, before, instant, next_law=next_law)
            letters.append(_letter(told))
        else:
            letters.append(_blank(spec, instant))
    return Word(tuple(letters), known_to, reached, next_law)


def heard(spec: CheckedSpec, samples: Sequence[Sample]) -> Sequence[Sample]:
    """The samples, each without NaN and null of a signal that ignores them.

    A sample that says nothing else is a sample all the same.
    """

    def counts(name: str, value: Value) -> bool:
        signal = spec.signals.get(name)
        return signal is None or not signal.ignores_nan or _update(0, value).value is not None

    return [
        Sample(sample.t, {name: v for name, v in sample.values.items() if counts(name, v)})
        for sample in samples
    ]


def _given(instant: int | None) -> Iterable[int]:
    return () if instant is None else (instant,)


def _positions(
    spec: CheckedSpec,
    samples: Sequence[Sample],
    outages: Iterable[Outage],
    first: int,
    end: int,
) -> Sequence[int]:
    """Where there is a position, or may be one."""
    match spec.time:
        case TimeModel.HELD:
            return range(first, end + 1)
        case TimeModel.SAMPLED:
            lost = (t for outage in outages for t in range(outage.first, outage.last + 1))
            return sorted({*(sample.t for sample in samples), *lost})
        case TimeModel.CLOCKED:
            period = spec.period or 1
            return range(-(-first // period) * period, end + 1, period)


def _is_sure(spec: CheckedSpec, instant: int, begun: int | None, outages: Iterable[Outage]) -> bool:
    """Whether there is a position, and every formula is not unknown there for want of one.

    Where every tick is one, or every so many-th, the trace may have begun in an outage, at any
    tick from there to the first sample that was read.

    Args:
        spec: gives the time model.
        instant: of the position.
        begun: the instant of the first sample that was read.
        outages: what was lost.
    """
    if spec.time is TimeModel.SAMPLED:
        return not any(outage.covers(instant) for outage in outages)
    return begun is not None and begun <= instant


def _blank(spec: CheckedSpec, instant: int) -> Letter:
    """What is known where there may be no position."""
    unknown = SignalState(
        updated=Truth.UNKNOWN, changed=Truth.UNKNOWN, born=True, moved=True, lost=True
    )
    return Letter(
        instant,
        dict.fromkeys(spec.signals, unknown),
        dict.fromkeys(spec.events, _UNKNOWN_EVENT),
        sure=False,
    )


_UNKNOWN_EVENT = EventState(Truth.UNKNOWN, (Occurrence(Truth.UNKNOWN, {}),))


@dataclass(frozen=True, slots=True)
class _Told:
    """What was told by an instant; to it falls what came after the position `before`."""

    spec: CheckedSpec
    samples: Sequence[Sample]
    names: frozenset[str] | None
    outages: Sequence[Outage]
    before: int | None
    instant: int
    next_law: bool

    def of(self, name: str) -> Sequence[_Entry]:
        """What was said of a name, in order; an outage is one entry, at its end."""
        lost = [_Entry(outage.last, None, lost=True) for outage in self.lost(name)]
        kept = [
            _Entry(sample.t, sample.values[name])
            for sample in self.samples
            if sample.t <= self.instant and name in sample.values
            if not any(outage.hides(sample.t) for outage in self.lost(name))
        ]
        return sorted([*lost, *kept], key=lambda entry: (entry.t, not entry.lost))

    def lost(self, name: str) -> Sequence[Outage]:
        """The outages of a name that have begun."""
        return [o for o in self.outages if name in o.names and o.first <= self.instant]

    def is_within(self, name: str) -> bool:
        """Whether the instant lies in an outage of a name."""
        return any(outage.covers(self.instant) for outage in self.lost(name))

    def is_touched(self, name: str) -> bool:
        """Whether what falls to this position may have been lost."""
        return any(outage.touches(self.before, self.instant) for outage in self.lost(name))

    def is_new(self, entry: _Entry) -> bool:
        """Whether an entry falls to this position."""
        return self.before is None or entry.t > self.before

    def has_source(self, name: str) -> bool:
        """Whether something can say what a name is.

        Raises:
            TraceError: it cannot, but did.
        """
        if self.names is None or name in self.names:
            return True
        for sample in self.samples:
            if sample.t <= self.instant and name in sample.values:
                raise TraceError(f"sample at {sample.t} ns holds `{name}`, which has no source")
        return False


@dataclass(frozen=True, slots=True)
class _Entry:
    """What was said of a name at an instant; `lost`: that nobody knows what was, until then."""

    t: int
    value: Value
    lost: bool = False


def _letter(told: _Told) -> Letter:
    return Letter(
        told.instant,
        {name: _signal(told, signal) for name, signal in told.spec.signals.items()},
        {name: _event(told, event) for name, event in told.spec.events.items()},
    )


def _event(told: _Told, event: Event) -> EventState:
    if not told.has_source(event.name) or told.is_within(event.name):
        return _UNKNOWN_EVENT
    new = [entry for entry in told.of(event.name) if told.is_new(entry)]
    found = tuple(one for entry in new for one in _occurrences(entry.value))
    if told.next_law:
        found = tuple(replace(one, payload=_at_edge(one.payload, event)) for one in found)
    updated = any(not entry.lost for entry in new)
    lost = Truth.UNKNOWN if told.is_touched(event.name) else Truth.FALSE
    return EventState(disjunction([truth_of(updated), lost]), found)


def _at_edge(payload: Payload, event: Event) -> Payload:
    return {
        name: at_edge(value, event.fields[name].kind) if name in event.fields else value
        for name, value in payload.items()
    }


def _signal(told: _Told, signal: Signal) -> SignalState:
    name = signal.name
    if not told.has_source(name):
        return SignalState(updated=Truth.UNKNOWN, changed=Truth.UNKNOWN)
    said = told.of(name)
    if not said:
        return SignalState()
    updates = [_update(entry.t, entry.value) for entry in said]
    if told.next_law:
        updates = [replace(one, value=at_edge(one.value, signal.type.kind)) for one in updates]
    last, within = updates[-1], told.is_within(name)
    stale = signal.stale_after is not None and told.instant > last.t + signal.stale_after
    # What was lost may have been the first value, and the update behind it.
    may_be_born = bool(told.lost(name))
    since_birth = list(dropwhile(lambda update: update.value is None, updates))
    return SignalState(
        value=None if stale or within else last.value,
        updated=_updated(told, name),
        changed=_changed(told, name, said, updates),
        last=last,
        before=updates[-2] if len(updates) > 1 else None,
        born=may_be_born or bool(since_birth),
        moved=may_be_born or len(since_birth) > 1,
        lost=not stale and (within or said[-1].lost),
    )


def _updated(told: _Told, name: str) -> Truth:
    """Whether an update falls to this position."""
    if told.is_within(name):
        return Truth.UNKNOWN
    kept = any(told.is_new(entry) and not entry.lost for entry in told.of(name))
    lost = Truth.UNKNOWN if told.is_touched(name) else Truth.FALSE
    return disjunction([truth_of(kept), lost])


def _changed(told: _Told, name: str, said: Sequence[_Entry], updates: Sequence[Update]) -> Truth:
    """Whether an update to another value does."""
    if told.is_within(name):
        return Truth.UNKNOWN
    pairs = zip(pairwise(updates), said[1:], strict=True)
    new = (_differ(*pair) for pair, now in pairs if told.is_new(now))
    return disjunction([*new, Truth.UNKNOWN if told.is_touched(name) else Truth.FALSE])


def _update(t: int, value: Value) -> Update:
    if not isinstance(value, bool | int | float | str):
        value = None
    return Update(t, known_scalar(value))


def _differ(earlier: Update, later: Update) -> Truth:
    if earlier.value is None or later.value is None:
        return Truth.UNKNOWN
    return truth_of(earlier.value != later.value)


def _occurrences(entry: Value) -> Iterable[Occurrence]:
    match entry:
        case None:
            return (Occurrence(Truth.UNKNOWN, {}),)
        case tuple():
            return tuple(Occurrence(Truth.TRUE, payload) for payload in entry)
        case bool() | int() | float() | str():
            return (Occurrence(Truth.TRUE, {}),) if entry else ()
        case payload:
            return (Occurrence(Truth.TRUE, payload),)
