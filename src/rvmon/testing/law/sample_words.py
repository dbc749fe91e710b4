"""Turns samples into words: finds the positions and the state of each name there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import dropwhile, pairwise

from rvmon.errors import TimeOrderError, TraceError
from rvmon.language.checked.specification import CheckedSpec, Event, Signal, TimeModel
from rvmon.testing.law import word as law
from rvmon.testing.law.numbers import at_edge, known_scalar
from rvmon.trace.sample import Payload, Sample, Value

MOST_TICKS = 1_000_000
"""The longest trace in ticks. Every tick is a position here, so tests use times of few ticks."""


def word_of(
    spec: CheckedSpec,
    samples: Sequence[Sample],
    *,
    end: int | None = None,
    advances: Sequence[int] = (),
    names: frozenset[str] | None = None,
    outages: Sequence[law.Outage] = (),
) -> law.Word:
    """Lay out a trace position by position.

    Args:
        spec: the specification, for its time model and names.
        samples: the samples, with strictly increasing times.
        end: the argument of `finish`, ticks.
        advances: the arguments of `advance`, ticks; assumed to fit the samples.
        names: the names that have a source; `None`: all.
        outages: the outages, in any order.

    Raises:
        TimeOrderError: the times do not increase strictly.
        TraceError: the trace is too long to be laid out tick by tick, or a sample holds a name
            without a source.

    Source: SEMANTICS, sections 1, 3 (The end) and 5; decision record 1.
    """
    for earlier, later in pairwise(samples):
        if later.t <= earlier.t:
            raise TimeOrderError(f"sample at {later.t} ns after one at {earlier.t} ns")
    stamps = [*(sample.t for sample in samples), *(outage.last for outage in outages)]
    reached = max([*advances, *stamps, *_given(end)], default=0)
    if not stamps:
        return law.Word((), None, reached)
    samples = without_ignored(spec, samples)
    first_sample = samples[0].t if samples else None
    first = min([*(outage.first for outage in outages), *_given(first_sample)])
    # `advance` makes all ticks before it known, except in sampled time, where it adds no position.
    settled = [] if spec.time is TimeModel.SAMPLED else [t - 1 for t in advances]
    known_to = max([*stamps, *settled, *_given(end)])
    reached = max(reached, known_to + 1)
    if reached - first > MOST_TICKS:
        raise TraceError(
            f"the trace spans {reached - first} ns, and the oracle visits every one of them: "
            f"scale durations and times so that at most {MOST_TICKS} remain"
        )
    instants = _positions(spec, samples, outages, first, known_to)
    histories = {
        name: _history_of(name, samples, outages, has_source=names is None or name in names)
        for name in (*spec.signals, *spec.events)
    }
    letters: list[law.Letter] = []
    for index, instant in enumerate(instants):
        if _is_sure(spec, instant, first_sample, outages):
            before = instants[index - 1] if index else None
            so_far = {name: history.by(before, instant) for name, history in histories.items()}
            since = letters[0].since if letters else instant
            letters.append(replace(_letter(spec, instant, so_far), since=since))
        else:
            letters.append(_blank(spec, instant))
    return law.Word(tuple(letters), known_to, reached)


def without_ignored(spec: CheckedSpec, samples: Sequence[Sample]) -> Sequence[Sample]:
    """The samples without the NaN and null values of signals that ignore them.

    A sample with nothing else is kept, as it is a position of sampled time.
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
    outages: Iterable[law.Outage],
    first: int,
    end: int,
) -> Sequence[int]:
    """The instants of all positions, certain or possible."""
    match spec.time:
        case TimeModel.HELD:
            return range(first, end + 1)
        case TimeModel.SAMPLED:
            lost = (t for outage in outages for t in range(outage.first, outage.last + 1))
            return sorted({*(sample.t for sample in samples), *lost})
        case TimeModel.CLOCKED:
            period = spec.period or 1
            return range(-(-first // period) * period, end + 1, period)


def _is_sure(
    spec: CheckedSpec, instant: int, first_sample: int | None, outages: Iterable[law.Outage]
) -> bool:
    """Whether an instant is certainly a position; if it may not be one, every formula is unknown.

    `first_sample` is the instant of the first sample that was read.

    In an outage of sampled time no tick is certainly a position, even if a sample was read there:
    `next` and `previous` cannot know which position is the neighbour. In the other time models the
    trace may have started in an outage, so no position before the first sample read is certain.
    """
    if spec.time is TimeModel.SAMPLED:
        return not any(outage.covers(instant) for outage in outages)
    return first_sample is not None and first_sample <= instant


def _blank(spec: CheckedSpec, instant: int) -> law.Letter:
    """The letter of a possible position."""
    unknown = law.SignalState(
        updated=law.Truth.UNKNOWN, changed=law.Truth.UNKNOWN, born=True, moved=True, lost=True
    )
    return law.Letter(
        instant,
        dict.fromkeys(spec.signals, unknown),
        dict.fromkeys(spec.events, _UNKNOWN_EVENT),
        sure=False,
    )


_UNKNOWN_EVENT = law.EventState(law.Truth.UNKNOWN, (law.Occurrence(law.Truth.UNKNOWN, {}),), lost=1)


@dataclass(frozen=True, slots=True)
class _Entry:
    """An update of a name."""

    t: int
    value: Value  # the new value; `None` for lost updates
    since: int  # the instant from which on it counts: for lost updates, the start of the outage
    lost: bool = False  # whether it stands for all updates lost in an outage


@dataclass(frozen=True, slots=True)
class _History:
    """The history of a name up to a position."""

    entries: Sequence[_Entry]  # its updates, in order
    outages: Sequence[law.Outage]  # its outages that have started
    before: int | None  # the previous position; updates after it belong to this one
    instant: int  # the instant of this position
    has_source: bool  # whether the name can be updated at all

    def by(self, before: int | None, instant: int) -> _History:
        """The part of the history up to an earlier position."""
        return _History(
            [entry for entry in self.entries if entry.since <= instant],
            [outage for outage in self.outages if outage.first <= instant], before, instant,
            self.has_source,
        )  # fmt: skip

    @property
    def is_within(self) -> bool:
        """Whether the position lies in an outage."""
        return any(outage.covers(self.instant) for outage in self.outages)

    @property
    def is_touched(self) -> bool:
        """Whether updates that belong to this position may have been lost."""
        return any(outage.touches(self.before, self.instant) for outage in self.outages)

    def is_new(self, entry: _Entry) -> bool:
        """Whether an update belongs to this position."""
        return self.before is None or entry.t > self.before


def _history_of(
    name: str, samples: Sequence[Sample], outages: Sequence[law.Outage], *, has_source: bool
) -> _History:
    """All updates of a name; a lost one comes before one that was read with the same stamp.

    Raises:
        TraceError: the name is updated although it has no source.
    """
    read = [sample for sample in samples if name in sample.values]
    if read and not has_source:
        raise TraceError(f"sample at {read[0].t} ns holds `{name}`, which has no source")
    of_name = [outage for outage in outages if name in outage.names]
    kept = [s for s in read if not any(outage.hides(s.t) for outage in of_name)]
    entries = [
        *(_Entry(outage.last, None, outage.first, lost=True) for outage in of_name),
        *(_Entry(sample.t, sample.values[name], sample.t) for sample in kept),
    ]
    entries.sort(key=lambda entry: (entry.t, not entry.lost))
    last = entries[-1].t if entries else 0
    return _History(entries, of_name, None, last, has_source)


def _letter(spec: CheckedSpec, instant: int, history: Mapping[str, _History]) -> law.Letter:
    return law.Letter(
        instant,
        {name: _signal(history[name], signal) for name, signal in spec.signals.items()},
        {name: _event(history[name], event) for name, event in spec.events.items()},
    )


def _event(history: _History, event: Event) -> law.EventState:
    if not history.has_source or history.is_within:
        return _UNKNOWN_EVENT
    new = [entry for entry in history.entries if history.is_new(entry)]
    occurrences = tuple(
        replace(occurrence, payload=_at_edge(occurrence.payload, event))
        for entry in new
        for occurrence in _occurrences(entry.value)
    )
    return law.EventState(_updated(history), occurrences, sum(entry.lost for entry in new))


def _at_edge(payload: Payload, event: Event) -> Payload:
    return {
        name: at_edge(value, event.fields[name].kind) if name in event.fields else value
        for name, value in payload.items()
    }


def _signal(history: _History, signal: Signal) -> law.SignalState:
    if not history.has_source:
        return law.SignalState(
            updated=law.Truth.UNKNOWN, changed=law.Truth.UNKNOWN, born=True, moved=True
        )
    if not history.entries:
        return law.SignalState()
    updates = [
        law.Update(entry.t, at_edge(_update(entry.t, entry.value).value, signal.type.kind))
        for entry in history.entries
    ]
    last, within = updates[-1], history.is_within
    stale = signal.stale_after is not None and history.instant > last.t + signal.stale_after
    # The lost updates may have been the first value, and the update after it.
    may_be_born = bool(history.outages)
    since_birth = list(dropwhile(lambda update: update.value is None, updates))
    return law.SignalState(
        value=None if stale or within else last.value, updated=_updated(history),
        changed=_changed(history, updates), last=last,
        before=updates[-2] if len(updates) > 1 else None, born=may_be_born or bool(since_birth),
        moved=may_be_born or len(since_birth) > 1,
        lost=not stale and (within or history.entries[-1].lost),
    )  # fmt: skip


def _updated(history: _History) -> law.Truth:
    """Whether an update of the name belongs to this position."""
    if history.is_within:
        return law.Truth.UNKNOWN
    kept = any(history.is_new(entry) and not entry.lost for entry in history.entries)
    return law.disjunction([law.truth_of(kept), _if_lost(history)])


def _changed(history: _History, updates: Sequence[law.Update]) -> law.Truth:
    """Whether an update to another value belongs to this position."""
    if history.is_within:
        return law.Truth.UNKNOWN
    pairs = zip(pairwise(updates), history.entries[1:], strict=True)
    new = (_differ(*pair) for pair, entry in pairs if history.is_new(entry))
    return law.disjunction([*new, _if_lost(history)])


def _if_lost(history: _History) -> law.Truth:
    return law.Truth.UNKNOWN if history.is_touched else law.Truth.FALSE


def _update(t: int, value: Value) -> law.Update:
    if not isinstance(value, bool | int | float | str):
        value = None
    return law.Update(t, known_scalar(value))


def _differ(earlier: law.Update, later: law.Update) -> law.Truth:
    if earlier.value is None or later.value is None:
        return law.Truth.UNKNOWN
    return law.truth_of(earlier.value != later.value)


def _occurrences(entry: Value) -> Iterable[law.Occurrence]:
    match entry:
        case None:
            return (law.Occurrence(law.Truth.UNKNOWN, {}),)
        case tuple():
            return tuple(law.Occurrence(law.Truth.TRUE, payload) for payload in entry)
        case bool() | int() | float() | str():
            return (law.Occurrence(law.Truth.TRUE, {}),) if entry else ()
        case payload:
            return (law.Occurrence(law.Truth.TRUE, payload),)
