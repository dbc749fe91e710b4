"""mstlo: bounded future formulas over dense time, signals held between their samples."""

from __future__ import annotations

import time
from importlib import import_module
from typing import Any


class Peer:
    """Answers requests by mstlo's monitors."""

    def __init__(self) -> None:
        self._mstlo: Any = import_module("mstlo_python")
        self._formulas: list[str] = []
        self._updates: list[tuple[str, float, float]] = []

    def judge(self, formula: str, kind: str, columns: dict[str, list[Any]]) -> dict[str, Any]:
        """The verdict at every tick, in the semantics that `kind` names."""
        monitor = self._mstlo.Monitor(self._mstlo.parse_formula(formula), semantics=kind)
        known = monitor.get_signal_identifiers()
        ticks = len(next(iter(columns.values())))
        verdicts: dict[float, Any] = {}
        for tick in range(ticks):
            for name, column in columns.items():
                first_or_last = tick in (0, ticks - 1)
                if name in known and (first_or_last or column[tick] != column[tick - 1]):
                    verdicts.update(
                        monitor.update(name, float(column[tick]), float(tick)).verdicts()
                    )
        return {"values": _per_tick(verdicts, ticks)}

    def load(
        self, formulas: list[str], kind: str, columns: dict[str, list[Any]], rows: int
    ) -> dict[str, Any]:
        """Lay the samples out as mstlo takes them: one call per signal and row."""
        self._formulas, self._kind = formulas, kind
        self._rows = rows
        self._updates = [
            (name, float(column[t]), float(t))
            for t in range(rows)
            for name, column in columns.items()
        ]
        return {"rows": rows}

    def run(self) -> dict[str, Any]:
        """One pass over the rows; the first instant with a false verdict per formula."""
        monitors = [
            self._mstlo.Monitor(self._mstlo.parse_formula(formula), semantics=self._kind)
            for formula in self._formulas
        ]
        firsts: list[float | None] = [None] * len(monitors)
        wanted = [(k, m.get_signal_identifiers(), m.update) for k, m in enumerate(monitors)]
        calls = [
            (k, update, name, value, t)
            for name, value, t in self._updates
            for k, names, update in wanted
            if name in names
        ]
        began = time.process_time_ns()
        for k, update, name, value, t in calls:
            for instant, verdict in update(name, value, t).verdicts():
                if not verdict:
                    first = firsts[k]
                    if first is None or instant < first:
                        firsts[k] = instant
        return {"cpu_ns": time.process_time_ns() - began, "violated": firsts}


def _per_tick(verdicts: dict[float, Any], ticks: int) -> list[Any]:
    """A verdict holds until the next one; nothing is known of ticks after the last."""
    values: list[Any] = [None] * ticks
    if not verdicts:
        return values
    last = max(verdicts)
    current = None
    instants = sorted(verdicts)
    for tick in range(ticks):
        while instants and instants[0] <= tick:
            current = verdicts[instants.pop(0)]
        values[tick] = current if tick <= last else None
    return values
