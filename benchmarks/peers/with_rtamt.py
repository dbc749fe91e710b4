"""rtamt: discrete (a position per sample) and dense time; the robustness's sign is the verdict."""

from __future__ import annotations

import logging
import time
from importlib import import_module
from typing import Any


class Peer:
    """Answers requests by rtamt's specifications."""

    def __init__(self) -> None:
        logging.disable(logging.WARNING)  # it warns of every variable
        self._rtamt: Any = import_module("rtamt")
        self._formulas: list[str] = []
        self._names: list[str] = []
        self._rows: list[tuple[int, list[tuple[str, float]]]] = []

    def judge(self, formula: str, kind: str, columns: dict[str, list[Any]]) -> dict[str, Any]:
        """The robustness at every tick; offline, or in discrete time sample by sample."""
        ticks = len(next(iter(columns.values())))
        if kind == "discrete":
            spec = _specified(self._rtamt.StlDiscreteTimeSpecification(), formula, list(columns))
            numbers = {name: [float(v) for v in column] for name, column in columns.items()}
            answer = spec.evaluate({"time": list(range(ticks)), **numbers})
            return {"values": [_finite(value) for _, value in answer]}
        if kind == "discrete online":
            return {"values": self._stepped(formula, columns, ticks)}
        if kind == "dense online":
            spec = self._rtamt.StlDenseTimeOnlineSpecification()
            return {"values": _online(spec, formula, columns, ticks)}
        spec = _specified(self._rtamt.StlDenseTimeSpecification(), formula, list(columns))
        signals = [[name, _steps(column)] for name, column in columns.items()]
        return {"values": _per_tick(spec.evaluate(*signals), ticks)}

    def load(
        self, formulas: list[str], kind: str, columns: dict[str, list[Any]], rows: int
    ) -> dict[str, Any]:
        """Lay the rows out as rtamt takes them online."""
        if kind != "discrete":
            raise ValueError("only discrete time is measured")
        self._formulas, self._names = formulas, list(columns)
        self._rows = [
            (t, [(name, float(columns[name][t])) for name in self._names]) for t in range(rows)
        ]
        return {"rows": rows}

    def _stepped(self, formula: str, columns: dict[str, list[Any]], ticks: int) -> list[Any]:
        """Discrete time sample by sample: of the past alone, each answer is for its own sample."""
        spec = _specified(self._rtamt.StlDiscreteTimeOnlineSpecification(), formula, list(columns))
        spec.pastify()
        values = []
        for tick in range(ticks):
            row = [(name, float(column[tick])) for name, column in columns.items()]
            values.append(_finite(spec.update(tick, row)))
        return values

    def run(self) -> dict[str, Any]:
        """One pass over the rows, online; the first row with a robustness below 0 per formula."""
        specs = []
        for formula in self._formulas:
            spec = self._rtamt.StlDiscreteTimeOnlineSpecification()
            specs.append(_specified(spec, formula, self._names))
            spec.pastify()
        firsts: list[int | None] = [None] * len(specs)
        numbered = [(k, spec.update) for k, spec in enumerate(specs)]
        began = time.process_time_ns()
        for t, row in self._rows:
            for k, update in numbered:
                if update(t, row) < 0 and firsts[k] is None:
                    firsts[k] = t
        return {"cpu_ns": time.process_time_ns() - began, "violated": firsts}


def _specified(spec: Any, formula: str, names: list[str]) -> Any:
    for name in names:
        spec.declare_var(name, "float")
    spec.spec = formula
    spec.parse()
    return spec


def _online(spec: Any, formula: str, columns: dict[str, list[Any]], ticks: int) -> list[Any]:
    """Dense time sample by sample: rtamt answers for an instant that lies its horizon back."""
    _specified(spec, formula, list(columns))
    spec.pastify()
    changes: list[list[float]] = []
    for tick in range(ticks):
        signals = [[name, [[tick, float(column[tick])]]] for name, column in columns.items()]
        changes += spec.update(*signals)
    return _per_tick(changes, ticks)


def _steps(column: list[Any]) -> list[list[float]]:
    """The points at which the column changes, and the last tick."""
    last = len(column) - 1
    return [
        [tick, float(value)]
        for tick, value in enumerate(column)
        if tick in (0, last) or value != column[tick - 1]
    ]


def _per_tick(changes: list[list[float]], ticks: int) -> list[Any]:
    values: list[Any] = [None] * ticks
    for time_, value in changes:
        for tick in range(ticks):
            if tick >= time_:
                values[tick] = _finite(value)
    return values


def _finite(value: float) -> float:
    """JSON knows no infinity."""
    return max(min(value, 1e300), -1e300)
