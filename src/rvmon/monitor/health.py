"""Input health of a run: unknown values, names that were stale or absent, losses, late samples."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from struct import iter_unpack
from typing import TYPE_CHECKING, Any

from rvmon import native
from rvmon.language.checked.names_read import source_names
from rvmon.language.checked.specification import CheckedSpec
from rvmon.monitor.intake import MOST_HELD, Intake, Turn
from rvmon.monitor.packed_plan import PlannedCore
from rvmon.trace.sample import Health, HealthKind, Value, payloads_of
from rvmon.trace.time import TIME_LIMIT, format_instant, whole_ticks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.recordings.batch import Batch


class HealthLog:
    """Counts unknown values by name and kind."""

    def __init__(self, planned: PlannedCore, absent: frozenset[str]) -> None:
        self.began: int | None = None  # the instant of the first sample
        # by signal, the instant of its first update, ticks; `None` if there was none
        self.first: dict[str, int | None] = dict.fromkeys(planned.packed.signals)
        self._planned = planned
        self._absent = absent
        self._seen: dict[tuple[HealthKind, str, str], tuple[int, int]] = {}

    def add(self, kind: HealthKind, shown: str, name: str, count: int, first: int) -> None:
        """Count further unknown values of the signal or field `shown`.

        `name` is the signal, or the event of the field; `first` the instant of the first one, in
        ticks.
        """
        if count:
            before, since = self._seen.get((kind, shown, name), (0, first))
            self._seen[kind, shown, name] = (before + count, since)

    def entries(self, run: native.Monitor, further: Iterable[Health] = ()) -> tuple[Health, ...]:
        """All entries of a finished run, sorted by name, each with the requirements that read it.

        `further` are the entries of the feed.
        """
        readers, names = self._planned.readers, list(self._planned.numbers)
        entries = [
            Health(kind, shown, count, at, readers.get(name, ()))
            for (kind, shown, name), (count, at) in self._seen.items()
        ]
        for name, ids in readers.items():
            if name in self._absent:
                entries.append(Health(HealthKind.ABSENT, name, 1, None, ids))
            elif name in self.first and self.began is not None and self.began != self.first[name]:
                at = self.first[name]
                since = "no value"
                if at is not None:
                    since = f"first value at {format_instant(at, self.began)}"
                entries.append(Health(HealthKind.MISSING, name, 1, self.began, ids, remark=since))
        for number, count, at in run.stale():
            ids = readers.get(names[number], ())
            entries.append(Health(HealthKind.STALE, names[number], count, at, ids))
        for health in further:
            ids = health.requirements or readers.get(health.name, ())
            entries.append(replace(health, requirements=ids))
        return tuple(sorted(entries, key=lambda entry: (entry.name, entry.kind)))


def of_intake(intake: Intake) -> list[Health]:
    """Entries about samples held back: conflicting values, and samples judged early."""
    entries = intake.conflicts.health()
    if intake.crowded is not None:
        count, first = intake.crowded
        early = f"evaluated before the delay was over: {MOST_HELD:,} samples were waiting"
        entries.append(Health(HealthKind.LATE, "buffer", count, first, remark=early))
    return entries


class Findings(HealthLog):
    """Collects input health while a recording is judged."""

    def __init__(self, planned: PlannedCore, absent: frozenset[str]) -> None:
        super().__init__(planned, absent)
        self._awaited = (self.first.keys() & planned.readers.keys()) - absent

    def note_sample(self, t: int, values: Mapping[str, Value]) -> None:
        """Note the unknown values of a sample, and which signals it is the first to update."""
        if self.began is None:
            self.began = t
        for name, value in values.items():
            if value is None or value != value:
                self._note(name, name, value, t)
            elif type(value) is dict or type(value) is tuple:
                for payload in payloads_of(value):
                    for field, scalar in (payload or {}).items():
                        if scalar is None or scalar != scalar:
                            self._note(f"{name}.{field}", name, scalar, t)
        for name in self._awaited & values.keys():
            self._arrived(name, t)

    def _note(self, shown: str, name: str, value: object, t: int) -> None:
        self.add(HealthKind.NONE if value is None else HealthKind.NAN, shown, name, 1, t)

    def note_batch(self, batch: Batch) -> None:
        """Note the same of a batch of rows."""
        from rvmon.recordings.batch import unknown_rows

        times = batch.times
        if self.began is None:
            self.began = int(times[0])
        for name in self._awaited & batch.signals.keys():
            row = batch.signals[name].first_given
            if row is not None:
                self._arrived(name, int(times[row]))
        columns = dict(batch.signals)
        for event, occurrences in batch.events.items():
            columns |= {f"{event}.{field}": cells for field, cells in occurrences.fields.items()}
            if (unknown := occurrences.unknown) is not None:
                self._add(HealthKind.NONE, event, event, times[unknown])
        for shown, cells in columns.items():
            is_signal = shown in batch.signals
            name = shown if is_signal else shown.rpartition(".")[0]
            for is_nan, at in unknown_rows(batch, cells, is_signal=is_signal):
                self._add(HealthKind.NAN if is_nan else HealthKind.NONE, shown, name, at)

    def _add(self, kind: HealthKind, shown: str, name: str, at: NDArray[Any]) -> None:
        if len(at):
            self.add(kind, shown, name, len(at), int(at[0]))

    def _arrived(self, name: str, t: int) -> None:
        self.first[name] = t
        self._awaited.discard(name)


def health_of_run(
    planned: PlannedCore, run: native.Monitor, absent: frozenset[str], further: Iterable[Health]
) -> tuple[Health, ...]:
    """The input health of a monitor's run, from the counters of the core.

    `further` are the entries of the feed.
    """
    log = HealthLog(planned, absent)
    log.began, _, _ = run.times()
    names = [(name, name) for name in planned.numbers]
    names += [(f"{event}.{field}", event) for event, field in planned.packed.fields]
    for (shown, name), arrivals in zip(names, iter_unpack("=5q", run.arrivals()), strict=True):
        came, none_count, none_first, nan_count, nan_first = arrivals
        if shown in log.first and came >= -TIME_LIMIT:
            log.first[name] = came
        log.add(HealthKind.NONE, shown, name, none_count, none_first)
        log.add(HealthKind.NAN, shown, name, nan_count, nan_first)
    return log.entries(run, further)


ANY = "samples"  # the name of an entry if the lost names are not known

_UNREAD = ""
"""Stands for all names that no requirement reads: in sampled time, their loss loses positions."""

_MOST_ENTRIES = 1_000
"""From this many entries on, new reasons are counted together as "for other reasons"."""


class Losses:
    """Tracks the outages of names and late samples of a run (SEMANTICS 1 and 6).

    `lose`, `find`, `miss` and `end_missed` return the turns to apply, at once or in order with the
    held-back samples; `turn` applies a turn to the core.
    """

    def __init__(
        self,
        checked: CheckedSpec,
        planned: PlannedCore,
        core: native.Monitor,
        intake: Intake | None,
    ) -> None:
        self._checked = checked
        self._planned = planned
        self._core = core
        self._intake = intake
        self._lost: set[str] = set()
        self._missed: set[str] = set()
        self._stretches: Counter[str] = Counter()
        self._seen: dict[tuple[HealthKind, str, str], tuple[int, int]] = {}

    @property
    def awaits_sample(self) -> bool:
        """Whether an outage from `miss` is open, which the next sample ends."""
        return bool(self._missed)

    def lose(
        self, names: Iterable[str] | None, since: int, until: int | None, why: str
    ) -> Sequence[Turn]:
        """The turns of an outage; see `rvmon.monitor.feed.FedMonitor.lose_ns`."""
        some = self._named(names)
        self._note(HealthKind.DROPPED, None if names is None else some, since, why)
        if until is None:
            some, self._lost = some - self._lost, self._lost | some
        return self._stretch(some, since, until)

    def find(self, names: Iterable[str] | None, at: int) -> Sequence[Turn]:
        """The turns that end outages of names at `at` (ticks, inclusive)."""
        some = self._named(names) & self._lost
        self._lost -= some
        return self._end(some, at)

    def miss(self, names: Iterable[str] | None, since: int | None, why: str) -> Sequence[Turn]:
        """The turns of an outage from sample `since` (ticks) to the next; `None`: no sample yet."""
        some = self._named(names)
        if since is None:
            self.come_late(names, 0, why)
            return ()
        self._note(HealthKind.DROPPED, None if names is None else some, since, why)
        some, self._missed = some - self._missed, self._missed | some
        # Where equal stamps are merged, the lost input may also have the stamp of `since` itself.
        return self._stretch(some, since + (self._intake is None), None)

    def end_missed(self, t: int) -> Sequence[Turn]:
        """The turns that end the outages from `miss`, before the next sample, at `t`."""
        some, self._missed = self._missed, set()
        return self._end(some, t - (self._intake is None))

    def miss_end(self, last: int) -> None:
        """Report to the core that missed input may belong anywhere after the last sample."""
        if self._missed:
            self._core.late(self._numbers(self._missed), last)

    def come_late(self, names: Iterable[str] | None, t: int, why: str) -> None:
        """Report to the core a late sample at `t` with these names (`None`: unknown)."""
        some = None if names is None else self._named(names)
        self._note(HealthKind.LATE, some, t, why)
        self._core.late(None if some is None else self._numbers(some), t)

    def turn(self, turn: Turn) -> None:
        """Apply a turn to the core; all samples before it must have been judged.

        Outages of a name may overlap. The first start and the last end change its state in the
        core. The turns in between are reported to the core as further losses, because the trace
        continues to their instants.
        """
        was = {name for name in turn.names if self._stretches[name]}
        self._stretches.update(dict.fromkeys(turn.names, 1 if turn.lost else -1))
        now = {name for name in turn.names if self._stretches[name]}
        for tell, some in ((self._core.lose, now), (self._core.found, was - now)):
            if _UNREAD in some:
                tell([], turn.t)
            if numbers := self._numbers(some):
                tell(numbers, turn.t)

    def _stretch(self, names: set[str], since: int, until: int | None) -> Sequence[Turn]:
        """The turns of an outage for what is not judged yet; the rest is reported as late."""
        if not names:
            return ()
        delay, floor = self._delay_and_floor()
        since = since - delay
        if since < floor:
            self._core.late(self._numbers(names), since)
            if until is not None and until + delay < floor:
                return ()
        turns = [Turn(max(since, floor), tuple(sorted(names)), lost=True)]
        return turns if until is None else [*turns, *self._end(names, until)]

    def _end(self, names: set[str], at: int) -> Sequence[Turn]:
        if not names:
            return ()
        delay, floor = self._delay_and_floor()
        return [Turn(max(at + delay, floor), tuple(sorted(names)), lost=False)]

    def _delay_and_floor(self) -> tuple[int, int]:
        """The ticks by which outages are widened, and the first instant not judged yet."""
        if self._intake is not None:
            return self._intake.delay, self._intake.floor
        _, last, reached = self._core.times()
        after_last = -TIME_LIMIT if last is None else last + 1
        return 0, after_last if reached is None else max(after_last, reached)

    def _named(self, names: Iterable[str] | None) -> set[str]:
        """Those of the given names that a requirement reads; `_UNREAD` if none is read.

        Raises:
            UnknownNameError: a name is not declared.
        """
        known = self._planned.numbers.keys()
        requested = source_names(self._checked, names)
        return {*known} if requested is None else {*(requested & known)} or {_UNREAD}

    def known(self, names: Iterable[Any]) -> set[str]:
        """Validate names from a snapshot; raises `KeyError` for an unknown one."""
        return {name for name in names if name == _UNREAD or self._planned.numbers[name] >= 0}

    def _numbers(self, names: Iterable[str]) -> list[int]:
        return [self._planned.numbers[name] for name in names if name != _UNREAD]

    def _note(self, kind: HealthKind, names: Iterable[str] | None, t: int, why: str) -> None:
        if len(self._seen) >= _MOST_ENTRIES and not any(why == known for _, _, known in self._seen):
            why = "for other reasons"
        for name in (ANY,) if names is None else sorted({*names} - {_UNREAD}):
            count, first = self._seen.get((kind, name, why), (0, t))
            self._seen[kind, name, why] = (count + 1, min(first, t))

    def health(self) -> list[Health]:
        """Entries about losses and late samples, with the reasons given."""
        readers = {ANY: tuple(self._planned.packed.ids), **self._planned.readers}
        return [
            Health(kind, name, count, first, readers.get(name, ()), why)
            for (kind, name, why), (count, first) in self._seen.items()
        ]

    def state(self) -> Mapping[str, Any]:
        """The state as JSON values."""
        return {
            "lost": sorted(self._lost),
            "missed": sorted(self._missed),
            "stretches": +self._stretches,
            "seen": [[*key, *entry] for key, entry in self._seen.items()],
        }

    def restore_state(self, state: Mapping[str, Any]) -> None:
        """Restore a state from `state`."""
        self._lost, self._missed = self.known(state["lost"]), self.known(state["missed"])
        for name in self.known(state["stretches"]):
            self._stretches[name] = whole_ticks(state["stretches"][name])
        for kind, name, why, count, first in state["seen"]:
            key = (HealthKind(kind), str(name), str(why))
            self._seen[key] = (whole_ticks(count), whole_ticks(first))
