"""The core in its two forms, stepped and fed rows, as the differential test drives monitors."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rvmon.errors import TimeOrderError
from rvmon.monitor import CompiledSpec, build_monitor
from rvmon.monitor.core.monitor import Monitor, restore
from rvmon.monitor.core.planned import PlannedCore, planned_core
from rvmon.monitor.core.recorded import report_of_run
from rvmon.testing.case import Case
from rvmon.trace.sample import Sample, Value
from rvmon.trace.schema import Kind
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report

_NO, _UNKNOWN, _YES, _NOTHING = 0, 1, 2, 255
"""What a row says of a name; see `core.h`."""

_LAYOUTS = {Kind.REAL: (0, "f8"), Kind.INT: (1, "i8"), Kind.LABEL: (1, "i8"), Kind.BOOL: (2, "u1")}
"""How a column is laid out: its number in `core.h`, and the type of its values."""


class Stepped:
    """A monitor of the core, asked now and then what is due: that must change nothing.

    Args:
        compiled: judged by.
        case: gives the sources.
    """

    def __init__(self, compiled: CompiledSpec, case: Case) -> None:
        self._monitor = build_monitor(compiled, sources=case.names)
        self._rng = random.Random(len(case.actions))
        self._due: int | None = None
        self._asked = False
        self._compiled = compiled
        self._interrupts: random.Random | None = None

    def take_up_again(self, rng: random.Random) -> None:
        """From now on a tenth of the calls goes to what is made of a snapshot."""
        self._interrupts = rng

    def _taken_up(self) -> Monitor:
        """The monitor, perhaps another one that goes on as it."""
        if self._interrupts is not None and self._interrupts.random() < 0.1:
            self._monitor = restore(self._compiled, self._monitor.snapshot())
        return self._monitor

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        """Take a sample.

        Raises:
            AssertionError: time alone decided what was not due.
        """
        decided = self._taken_up().step_ns(t_ns, values)
        if self._asked and (self._due is None or t_ns < self._due):
            early = [one for one in decided if (one.decided or 0) < t_ns]
            assert not early, f"due was {self._due}, and at {t_ns} came {early}"
        self._asked = self._rng.random() < 0.3
        if self._asked:
            self._due = self.next_due
        return decided

    def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]:
        """Let time pass."""
        self._asked = False
        return self._taken_up().advance_ns(t_ns)

    def lose(self, names: Iterable[str], since: int, /) -> bool:
        """Lose some names."""
        self._asked = False
        self._taken_up().lose_ns(names, since)
        return True

    def found(self, names: Iterable[str], at: int, /) -> bool:
        """Find them again."""
        self._asked = False
        self._taken_up().found_ns(names, at)
        return True

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
        """End the trace."""
        report = self._taken_up().finish_ns(t_ns)
        self._interrupts = None  # a finished run is not put away
        return report

    @property
    def open(self) -> Sequence[Attempt]:
        """The attempts that are undecided now."""
        return self._monitor.open

    @property
    def next_due(self) -> int | None:
        """The next instant at which time alone can decide something."""
        return self._monitor.next_due


class ByRows:
    """A run of the core that is fed columns, several rows at once; it says nothing before the end.

    A sample now and then comes by itself. One is told in several rows of its instant if an event
    brings several payloads, and now and then without that.

    Args:
        compiled: judged by.
        case: gives the sources.
    """

    silent = True
    """It says nothing before the end."""

    def __init__(self, compiled: CompiledSpec, case: Case) -> None:
        names = (*compiled.checked.signals, *compiled.checked.events)
        absent = frozenset() if case.names is None else frozenset(names) - case.names
        self._planned = planned_core(compiled)
        self._run = self._planned.monitor(absent)
        self._waiting: list[Sample] = []
        self._rng = random.Random(len(case.actions))

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        """Take a sample."""
        if self._rng.random() < 0.1:
            self._feed()
            if not self._run.judge(t_ns, self._planned.plain(t_ns, values), True):
                raise TimeOrderError(f"the sample at {t_ns} was not taken")
        else:
            self._waiting += _rows_of(Sample(t_ns, values), self._rng)
        return ()

    def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]:
        """Let time pass."""
        self._feed()
        self._run.advance(t_ns)
        return ()

    def lose(self, names: Iterable[str], since: int, /) -> bool:
        """Lose some names."""
        self._feed()
        return self._run.lose([self._planned.numbers[name] for name in names], since)

    def found(self, names: Iterable[str], at: int, /) -> bool:
        """Find them again."""
        self._feed()
        return self._run.found([self._planned.numbers[name] for name in names], at)

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
        """End the trace."""
        self._feed()
        origin, _, _ = self._run.times()
        end = self._run.finish(t_ns)
        return report_of_run(self._planned, self._run, origin or 0, end)

    def _feed(self) -> None:
        samples, self._waiting = self._waiting, []
        names = dict.fromkeys(name for sample in samples for name in sample.values)
        columns = tuple(column_of(self._planned, name, samples) for name in names)
        taken = self._run.rows(np.array([sample.t for sample in samples], "i8"), columns)
        if taken < len(samples):
            raise TimeOrderError(f"row {taken} was not taken")


def _rows_of(sample: Sample, rng: random.Random) -> Iterator[Sample]:
    """A sample as rows of its instant."""
    payloads = {name: value for name, value in sample.values.items() if isinstance(value, tuple)}
    first = {name: value[0] if value else False for name, value in payloads.items()}
    values: dict[str, Value] = {**sample.values, **first}
    apart = [name for name in values if rng.random() < 0.1]
    yield Sample(sample.t, {name: values[name] for name in values if name not in apart})
    for name in apart:
        yield Sample(sample.t, {name: values[name]})
    for name, more in payloads.items():
        yield from (Sample(sample.t, {name: payload}) for payload in more[1:])


def column_of(planned: PlannedCore, name: str, samples: Sequence[Sample]) -> tuple[Any, ...]:
    """What samples say of a name, as `rows` of the core takes it."""
    number, kind = planned.numbers[name], planned.packed.signals.get(name)
    said = [sample.values.get(name, _ABSENT) for sample in samples]
    if kind is not None:
        return number, _cells(planned, kind, said)
    fields = [field for event, field in planned.packed.fields if event == name]
    laid = [
        _cells(
            planned,
            planned.packed.fields[name, field],
            [one.get(field, _ABSENT) if isinstance(one, Mapping) else _ABSENT for one in said],
        )
        for field in fields
    ]
    return number, _says(said), tuple(laid) if fields else None


_ABSENT = object()


def _says(values: Sequence[Any]) -> NDArray[np.uint8]:
    """What rows say of an event."""
    found = (
        _NOTHING if one is _ABSENT else _UNKNOWN if one is None else _NO if one is False else _YES
        for one in values
    )
    return np.fromiter(found, np.uint8, len(values))


def _cells(
    planned: PlannedCore, kind: Kind, values: Sequence[Any]
) -> tuple[int, NDArray[Any], NDArray[np.uint8] | None]:
    """The values of a signal or field, and what rows say of it."""
    layout, type_ = _LAYOUTS[kind]
    known = [0 if one is _ABSENT or one is None else one for one in values]
    if kind is Kind.LABEL:
        known = [planned.packed.labels[one] if isinstance(one, str) else 0 for one in known]
    says = [_NOTHING if one is _ABSENT else _UNKNOWN if one is None else _YES for one in values]
    every = all(one == _YES for one in says)
    return layout, np.array(known, type_), None if every else np.array(says, np.uint8)
