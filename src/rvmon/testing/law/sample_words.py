"""From samples to words: which instants are positions, and what is known at each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import dropwhile, pairwise

from rvmon.errors import TimeOrderError, TraceError
from rvmon.spec.checked.specification import CheckedSpec, TimeModel
from rvmon.testing.law.kleene import Truth, disjunction, truth_of
from rvmon.testing.law.numbers import known_scalar
from rvmon.testing.law.word import EventState, Letter, Occurrence, SignalState, Update, Word
from rvmon.trace.sample import Sample, Value

MOST_TICKS = 1_000_000
"""Longer traces are refused: every tick is a position here, so tests count in nanoseconds."""


def word_of(
    spec: CheckedSpec,
    samples: Sequence[Sample],
    *,
    end: int | None = None,
    advances: Sequence[int] = (),
    names: frozenset[str] | None = None,
) -> Word:
    """Lay a trace out position by position.

    Args:
        spec: gives the time model and the names.
        samples: with strictly increasing times.
        end: what `finish` was given, ticks.
        advances: what `advance` was given, ticks; the samples are taken to fit.
        names: the names that have a source; `None`: all.

    Raises:
        TimeOrderError: the times do not increase.
        TraceError: the trace is too long to be laid out tick by tick, or a sample holds a name
            without a source.

    Source: SEMANTICS, sections 1 and 3 (The end); decision record 1.
    """
    for earlier, later in pairwise(samples):
        if later.t <= earlier.t:
            raise TimeOrderError(f"sample at {later.t} ns after one at {earlier.t} ns")
    reached = max([*advances, *(sample.t for sample in samples), *_given(end)], default=0)
    if not samples:
        return Word((), None, reached)
    samples = heard(spec, samples)
    first, last = samples[0].t, samples[-1].t
    # In sampled time `advance` says only what will not come; else it settles all ticks before.
    settled = [] if spec.time is TimeModel.SAMPLED else [t - 1 for t in advances]
    known_to = max([last, *settled, *_given(end)])
    if reached - first > MOST_TICKS:
        raise TraceError(
            f"the trace spans {reached - first} ns, and the oracle walks every one of them: "
            f"scale durations and times so that at most {MOST_TICKS} remain"
        )
    instants = _positions(spec, samples, known_to)
    letters = []
    for index, instant in enumerate(instants):
        before = instants[index - 1] if index else None
        letters.append(_letter(spec, samples, before, instant, names))
    return Word(tuple(letters), known_to, reached)


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


def _given(end: int | None) -> Iterable[int]:
    return () if end is None else (end,)


def _positions(spec: CheckedSpec, samples: Sequence[Sample], end: int) -> Sequence[int]:
    first = samples[0].t
    match spec.time:
        case TimeModel.HELD:
            return range(first, end + 1)
        case TimeModel.SAMPLED:
            return [sample.t for sample in samples]
        case TimeModel.CLOCKED:
            period = spec.period or 1
            return range(-(-first // period) * period, end + 1, period)


def _letter(
    spec: CheckedSpec,
    samples: Sequence[Sample],
    before: int | None,
    instant: int,
    names: frozenset[str] | None,
) -> Letter:
    """What is known at `instant`; to it falls what came after the position `before`."""
    past = [sample for sample in samples if sample.t <= instant]
    new = [sample for sample in past if before is None or sample.t > before]
    signals = {}
    for name, signal in spec.signals.items():
        if names is not None and name not in names:
            _refuse(name, past)
            signals[name] = SignalState(updated=Truth.UNKNOWN, changed=Truth.UNKNOWN)
        else:
            signals[name] = _signal(name, past, new, instant, signal.stale_after)
    events = {}
    for name in spec.events:
        if names is not None and name not in names:
            _refuse(name, past)
            events[name] = EventState(Truth.UNKNOWN, (Occurrence(Truth.UNKNOWN, {}),))
        else:
            entries = [sample.values[name] for sample in new if name in sample.values]
            found = tuple(occurrence for entry in entries for occurrence in _occurrences(entry))
            events[name] = EventState(truth_of(bool(entries)), found)
    return Letter(instant, signals, events)


def _refuse(name: str, samples: Sequence[Sample]) -> None:
    for sample in samples:
        if name in sample.values:
            raise TraceError(f"sample at {sample.t} ns holds `{name}`, which has no source")


def _signal(
    name: str,
    past: Sequence[Sample],
    new: Sequence[Sample],
    instant: int,
    stale_after: int | None,
) -> SignalState:
    updates = [_update(s.t, s.values[name]) for s in past if name in s.values]
    if not updates:
        return SignalState()
    count = sum(name in sample.values for sample in new)
    pairs = list(pairwise(updates))
    last = updates[-1]
    stale = stale_after is not None and instant > last.t + stale_after
    since_birth = list(dropwhile(lambda update: update.value is None, updates))
    return SignalState(
        value=None if stale else last.value,
        updated=truth_of(count > 0),
        changed=disjunction(_differ(a, b) for a, b in pairs[max(len(updates) - 1 - count, 0) :]),
        last=last,
        before=updates[-2] if len(updates) > 1 else None,
        born=bool(since_birth),
        moved=len(since_birth) > 1,
    )


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
