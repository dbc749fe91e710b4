"""reelay's Python package: past formulas; discrete (a position per update) and dense time."""

from __future__ import annotations

import time
from importlib import import_module
from typing import Any


class Peer:
    """Answers requests by reelay's monitors."""

    def __init__(self) -> None:
        self._reelay: Any = import_module("reelay")
        self._make: Any = None
        self._formulas: list[str] = []
        self._rows: list[dict[str, Any]] = []

    def judge(self, formula: str, kind: str, columns: dict[str, list[Any]]) -> dict[str, Any]:
        """The verdict, or with `robustness` in the kind the robustness, at every tick.

        `dense sparse` gives reelay changes only.
        """
        time_model, _, semantics = kind.partition(" ")
        sparse = semantics == "sparse"
        semantics = "boolean" if sparse or not semantics else semantics
        ticks = len(next(iter(columns.values())))
        number = float if semantics == "robustness" else lambda value: value
        rows = [{name: number(column[i]) for name, column in columns.items()} for i in range(ticks)]
        if time_model == "discrete":
            monitor = self._reelay.discrete_timed_monitor(
                pattern=formula, semantics=semantics, condense=False
            )
            return {"values": [_finite(monitor.update(row)["value"]) for row in rows]}
        monitor = self._reelay.dense_timed_monitor(pattern=formula, semantics=semantics)
        changes: list[dict[str, Any]] = []
        # Every tick, also without a change: of a longer stretch that starts and ends true, with
        # false at its beginning, the Python package does not print the changes.
        for tick, row in enumerate([*rows, rows[-1]]):
            if not sparse or row != rows[tick - 1] or tick in (0, ticks):
                changes += monitor.update({"time": tick, **row})
        return {"values": _per_tick(changes, ticks)}

    def load(
        self, formulas: list[str], kind: str, columns: dict[str, list[Any]], rows: int
    ) -> dict[str, Any]:
        """Lay the rows out as reelay takes them; monitors are made in `run`."""
        names = list(columns)
        self._rows = [
            dict(zip(names, values, strict=True))
            for values in zip(*(columns[name] for name in names), strict=True)
        ]
        if kind == "dense":
            self._rows = [{"time": t, **row} for t, row in enumerate(self._rows)]
        self._formulas = formulas
        self._make = (
            (lambda f: self._reelay.discrete_timed_monitor(pattern=f, condense=False))
            if kind == "discrete"
            else (lambda f: self._reelay.dense_timed_monitor(pattern=f))
        )
        if kind not in ("discrete", "dense") or len(self._rows) != rows:
            raise ValueError(f"{kind}, {len(self._rows)} rows for {rows}")
        self._dense = kind == "dense"
        return {"rows": rows}

    def run(self) -> dict[str, Any]:
        """One pass over the rows; the first row at which each formula was false."""
        updates = [self._make(formula).update for formula in self._formulas]
        violated: list[int | None] = [None] * len(updates)
        rows = self._rows
        if len(updates) == 1 and not self._dense:
            update, first = updates[0], None
            began = time.process_time_ns()
            for row in rows:
                if not update(row)["value"] and first is None:
                    first = row
            spent = time.process_time_ns() - began
            violated[0] = None if first is None else _index(rows, first)
            return {"cpu_ns": spent, "violated": violated}
        firsts: list[Any] = [None] * len(updates)
        numbered = list(enumerate(updates))
        began = time.process_time_ns()
        if self._dense:
            for row in rows:
                for k, update in numbered:
                    for change in update(row):
                        if not change["value"] and firsts[k] is None:
                            firsts[k] = change["time"]
            spent = time.process_time_ns() - began
            return {"cpu_ns": spent, "violated": firsts}
        for row in rows:
            for k, update in numbered:
                if not update(row)["value"] and firsts[k] is None:
                    firsts[k] = row
        spent = time.process_time_ns() - began
        violated = [None if row is None else _index(rows, row) for row in firsts]
        return {"cpu_ns": spent, "violated": violated}


def _index(rows: list[dict[str, Any]], row: dict[str, Any]) -> int:
    return next(i for i, candidate in enumerate(rows) if candidate is row)


def _per_tick(changes: list[dict[str, Any]], ticks: int) -> list[Any]:
    """Spread changes (each holds until the next) over the ticks; `None` where nothing is known."""
    values: list[Any] = [None] * ticks
    for change in changes:
        for tick in range(ticks):
            if tick >= change["time"]:
                values[tick] = _finite(change["value"])
    return values


def _finite(value: Any) -> Any:
    """JSON knows no infinity."""
    return max(min(value, 1e300), -1e300) if isinstance(value, float) else value
