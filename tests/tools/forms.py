"""The core in its forms, stepped and fed rows, as the differential test drives monitors."""

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rvmon.errors import RvmonError, TimeOrderError
from rvmon.language.checked.specification import CheckedSpec
from rvmon.monitor.compiled_spec import CompiledSpec, compile_spec
from rvmon.monitor.monitor import Monitor, build_monitor, restore
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.monitor.records import report_of_run
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Health, HealthKind, Sample, Value
from rvmon.trace.schema import Kind
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report
from tests.tools.drive import Monitored
from tests.tools.health import readers_of

FORMS = ("c", "c rows")
"""The core, stepped, and fed rows."""

WAYS = ("next", "interrupt")
"""How it may be stepped: in portions that the next stamp settles; put away and taken up again."""

_NO, _UNKNOWN, _YES, _NOTHING = 0, 1, 2, 255
"""What a row says of a name; see `core.h`."""

_LAYOUTS = {Kind.REAL: (0, "f8"), Kind.INT: (1, "i8"), Kind.LABEL: (1, "i8"), Kind.BOOL: (2, "u1")}
"""How a column is laid out: its number in `core.h`, and the type of its values."""


class Compiler:
    """Compiles specifications; that of one case serves the next case and all makers too."""

    def __init__(self) -> None:
        self._spec: CheckedSpec | None = None
        self._compiled: CompiledSpec | None = None

    def __call__(self, spec: CheckedSpec) -> CompiledSpec:
        """The compiled specification."""
        if self._compiled is None or spec is not self._spec:
            self._compiled = compile_spec(spec)
            self._spec = spec
        return self._compiled


class Maker:
    """Makes monitors of one form; what is compiled for a specification serves the next case too.

    Args:
        form: one of `FORMS`; `c` perhaps followed by `+next`, `+interrupt`, or both.
        compiler: shared with other makers; default: its own.

    Raises:
        RvmonError: there is no such form, or it is not driven so.
    """

    def __init__(self, form: str = "c", compiler: Compiler | None = None) -> None:
        self._form, *ways = form.split("+")
        if self._form not in FORMS or (ways and self._form != "c") or {*ways} - {*WAYS}:
            known = ", ".join(FORMS)
            raise RvmonError(f"no form `{form}`: there are {known}; c also with +next, +interrupt")
        self._ways = ways
        self._compile = compiler or Compiler()

    def __call__(self, case: Case) -> Monitored:
        """A fresh monitor for a case."""
        compiled = self._compile(case.spec)
        if self._form == "c rows":
            return ByRows(compiled, case)
        rng = random.Random(len(case.actions))
        settle = "next" if "next" in self._ways else "now"
        monitor: Any = build_monitor(compiled, settle=settle, sources=case.names)
        if "interrupt" in self._ways:
            monitor = Interrupted(monitor, rng, share=rng.choice((0.1, 1)))
        return HeldBack(monitor, case.spec, rng) if settle == "next" else Stepped(monitor, rng)


class Interrupted:
    """Before some calls, or all, a monitor is replaced by the one that its snapshot gives."""

    def __init__(self, monitor: Monitor, rng: random.Random, share: float) -> None:
        self._monitor = monitor
        self._rng = rng
        self._share = share

    def __getattr__(self, name: str) -> Any:
        if self._rng.random() < self._share:
            self._monitor = restore(self._monitor.compiled, self._monitor.snapshot())
        if name == "finish_ns":  # a finished run is not put away
            self._share = 0
        return getattr(self._monitor, name)


class Stepped:
    """A monitor that is asked now and then what is due: that must change nothing."""

    def __init__(self, monitor: Any, rng: random.Random) -> None:
        self._monitor = monitor
        self._rng = rng
        self._due: int | None = None
        self._asked = False

    def __getattr__(self, name: str) -> Any:
        self._asked = False  # whatever else is told, what was due may be another
        return getattr(self._monitor, name)

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        """Take a sample."""
        decided: Sequence[Attempt] = self._monitor.step_ns(t_ns, values)
        if self._asked and (self._due is None or t_ns < self._due):
            early = [one for one in decided if (one.decided or 0) < t_ns]
            assert not early, f"due was {self._due}, and at {t_ns} came {early}"
        asked = self._rng.random() < 0.3
        if asked:
            self._due = self._monitor.next_due
        self._asked = asked
        return decided


class HeldBack(Stepped):
    """Tells a monitor each sample as several of one stamp, which come to the same.

    The order of the names is random; a signal may come with another value before its last, an event
    may be denied before it occurs, and of two payloads each may come by itself.
    """

    def __init__(self, monitor: Any, spec: CheckedSpec, rng: random.Random) -> None:
        super().__init__(monitor, rng)
        self.monitor = monitor
        self._spec = spec
        self._conflicts: dict[str, tuple[int, int]] = {}

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        """Take a sample in portions; returns what all of them decided."""
        decided: list[Attempt] = []
        for portion in self._portions(t_ns, values):
            decided += self.monitor.step_ns(t_ns, portion)
        return decided

    def _portions(self, t: int, values: Mapping[str, Value]) -> list[dict[str, Value]]:
        portions: list[dict[str, Value]] = [{} for _ in range(self._rng.randint(1, 3))]
        names = list(values)
        self._rng.shuffle(names)
        last = len(portions) - 1
        for name in names:
            place = self._rng.randint(0, last)
            portions[place][name] = values[name]
            if place and self._rng.random() < 0.3:
                portions[place - 1].update(self._before(t, name, values[name], portions[place]))
        return portions

    def _before(self, t: int, name: str, value: Value, after: dict[str, Value]) -> dict[str, Value]:
        """What may come of a name before its value at the same stamp."""
        if isinstance(value, tuple):
            first, *rest = value
            after[name] = tuple(rest)
            return {name: (first,)}
        if name in self._spec.events:
            return {name: False if value is not None else None}
        if value is None or name in self._spec.ignoring:
            return {name: None}
        count, first_at = self._conflicts.get(name, (0, t))
        self._conflicts[name] = (count + 1, first_at)
        return {name: None}

    def health(self) -> list[Health]:
        """The findings that the other values gave rise to."""
        readers = readers_of(self._spec)
        return [
            Health(HealthKind.CONFLICT, name, count, first, readers.get(name, ()))
            for name, (count, first) in self._conflicts.items()
        ]


class ByRows:
    """A run of the core that is fed columns, several rows at once; it says nothing before the end.

    A sample now and then comes by itself. One is told in several rows of its instant if an event
    brings several payloads, and now and then without that.
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
        if self._rng.random() < 0.1:
            self._feed()
            if not self._run.judge(t_ns, self._planned.plain(t_ns, values), True):
                raise TimeOrderError(f"the sample at {t_ns} was not taken")
        else:
            self._waiting += _rows_of(Sample(t_ns, values), self._rng)
        return ()

    def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]:
        self._feed()
        self._run.advance(t_ns)
        return ()

    def lose_ns(self, names: Iterable[str], since: int, /) -> None:
        self._feed()
        assert self._run.lose([self._planned.numbers[name] for name in names], since)

    def found_ns(self, names: Iterable[str], at: int, /) -> None:
        self._feed()
        assert self._run.found([self._planned.numbers[name] for name in names], at)

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
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
