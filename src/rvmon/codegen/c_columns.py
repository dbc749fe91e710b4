"""Samples as the columns of a compiled monitor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.codegen.c_batch import ADVANCE, MORE, NO, SAMPLE, UNKNOWN, YES, Column
from rvmon.codegen.c_exact import too_large
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_samples import value_type
from rvmon.trace.sample import Sample, Value

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Rows:
    """Samples as `rvmon.codegen.c_batch.BatchRun.feed` takes them.

    Attributes:
        times: int64[n] ticks.
        columns: by signal, event, and `event.field`.
        kinds: uint8[n], of each row.
    """

    times: NDArray[np.int64]
    columns: Mapping[str, Column]
    kinds: NDArray[np.uint8]


def rows_of_samples(
    samples: Sequence[Sample | int], names: Names, limits: Mapping[str, int]
) -> Rows:
    """One row per sample, and one before it for each further payload of an event in it.

    Args:
        samples: with names and values that the specification can take; an instant instead says how
            far time has come.
        names: of the compiled plan.
        limits: of whole numbers, by signal and `event.field`.

    Raises:
        TraceError: a whole number is too large.
    """
    rows: list[tuple[int, int, Mapping[str, Value]]] = []
    for sample in samples:
        if isinstance(sample, int):
            rows.append((sample, ADVANCE, {}))
        else:
            *more, last = _payloads_apart(sample.values)
            rows += [(sample.t, MORE, values) for values in more]
            rows.append((sample.t, SAMPLE, last))
    columns = _Columns(names, limits, len(rows)).of([Sample(t, values) for t, _, values in rows])
    return Rows(
        np.array([t for t, _, _ in rows], np.int64),
        columns,
        np.array([kind for _, kind, _ in rows], np.uint8),
    )


def _payloads_apart(values: Mapping[str, Value]) -> list[Mapping[str, Value]]:
    """What stands in each row of a sample: payloads but the last ones, then the rest."""
    several = {
        name: value for name, value in values.items() if isinstance(value, tuple) and len(value) > 1
    }
    count = max(map(len, several.values()), default=1)
    rows: list[Mapping[str, Value]] = [
        {name: value[n - count] for name, value in several.items() if count - n <= len(value)}
        for n in range(count - 1)
    ]
    return [*rows, {**values, **{name: value[-1] for name, value in several.items()}}]


class _Columns:
    def __init__(self, names: Names, limits: Mapping[str, int], count: int) -> None:
        plan = names.plan
        self.names = names
        self.limits = limits
        self.states = {name: np.zeros(count, np.uint8) for name in (*plan.signals, *plan.events)}
        self.values: dict[str, NDArray[Any]] = {
            name: np.zeros(count, bool if value_type(plan, name) == "uint8_t" else float)
            for name in plan.signals
        }
        self.values |= {f"{event}.{field}": np.full(count, np.nan) for event, field in names.fields}

    def of(self, samples: Sequence[Sample]) -> dict[str, Column]:
        for row, sample in enumerate(samples):
            for name, value in sample.values.items():
                if name in self.names.plan.signals:
                    self.set_signal(name, row, value, sample.t)
                else:
                    self.set_event(name, row, value, sample.t)
        return {
            name: Column(self.states.get(name), self.values.get(name))
            for name in (*self.states, *self.values)
        }

    def set_signal(self, name: str, row: int, value: Any, t: int) -> None:
        known = value is not None and value == value
        self.states[name][row] = YES if known else UNKNOWN
        if known:
            self.set_value(name, row, value, t)

    def set_event(self, event: str, row: int, value: Value, t: int) -> None:
        if isinstance(value, tuple):
            value = value[0] if value else False
        self.states[event][row] = UNKNOWN if value is None else NO if value is False else YES
        if isinstance(value, Mapping):
            for field, scalar in value.items():
                if scalar is not None:
                    self.set_value(f"{event}.{field}", row, scalar, t)

    def set_value(self, name: str, row: int, value: bool | int | float | str, t: int) -> None:
        if isinstance(value, int) and abs(value) > self.limits[name]:
            raise too_large(name, value, self.limits[name], t)
        self.values[name][row] = self.names.label(value) if isinstance(value, str) else value
