"""Samples as the columns of a compiled monitor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.codegen.c_batch import NO, UNKNOWN, YES, Column
from rvmon.codegen.c_exact import several_payloads, too_large
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_samples import value_type
from rvmon.trace.sample import Sample, Value

if TYPE_CHECKING:
    from numpy.typing import NDArray


def columns_of_samples(
    samples: Sequence[Sample], names: Names, limits: Mapping[str, int]
) -> dict[str, Column]:
    """One row per sample.

    Args:
        samples: with names and values that the specification can take.
        names: of the compiled plan.
        limits: of whole numbers, by signal and `event.field`.

    Raises:
        TraceError: an instant has two payloads of one event, or a whole number is too large.
    """
    return _Columns(names, limits, len(samples)).of(samples)


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
            if len(value) > 1:
                raise several_payloads(event, len(value), t)
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
