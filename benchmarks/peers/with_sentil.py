"""SENTIL: formulas over samples a tick apart, judged by their robustness."""

from __future__ import annotations

import time
from importlib import import_module
from typing import Any


class Peer:
    """Answers requests by SENTIL's monitors."""

    def __init__(self) -> None:
        self._sentil: Any = import_module("sentil")
        self._formulas: list[str] = []
        self._columns: dict[str, list[Any]] = {}
        self._offline = False

    def judge(self, formula: str, kind: str, columns: dict[str, list[Any]]) -> dict[str, Any]:  # noqa: ARG002 - it has one semantics
        """The robustness at every tick; a window that the trace cuts short counts as it is."""
        ticks = len(next(iter(columns.values())))
        trace = self._sentil.Trace([float(tick) for tick in range(ticks)])
        for name, column in columns.items():
            trace.add_signal(name, [float(value) for value in column])
        return {"values": list(self._sentil.parse(formula).robustness_signal(trace))}

    def load(
        self,
        formulas: list[str],
        kind: str,
        columns: dict[str, list[Any]],
        rows: int,
    ) -> dict[str, Any]:
        """Keep what is to be passed over."""
        self._formulas = formulas
        self._offline = kind.endswith("offline")
        self._columns = columns
        return {"rows": rows}

    def run(self) -> dict[str, Any]:
        """One pass over the rows; the row at which each formula was found to be violated."""
        if self._offline:
            return self._pass_offline()
        passes = [self._pass_of(formula) for formula in self._formulas]
        firsts: list[int | None] = [None] * len(passes)
        spent = 0
        for number, (update, rows) in enumerate(passes):
            began = time.process_time_ns()
            for tick, row in rows:
                if update(tick, row).upper < 0 and firsts[number] is None:
                    firsts[number] = int(tick)
            spent += time.process_time_ns() - began
        return {"cpu_ns": spent, "violated": firsts}

    def _pass_offline(self) -> dict[str, Any]:
        """The robustness of all rows at once; of violations nothing is said."""
        ticks = range(len(next(iter(self._columns.values()))))
        named = {name: [float(cell) for cell in one] for name, one in self._columns.items()}
        trace = self._sentil.Trace([float(tick) for tick in ticks], named)
        short = self._sentil.Trace([0.0], {name: one[:1] for name, one in named.items()})
        parsed = [self._sentil.parse(formula) for formula in self._formulas]
        for formula in parsed:
            formula.robustness_signal(short)  # what the first call makes ready is not measured
        began = time.process_time_ns()
        for formula in parsed:
            formula.robustness_signal(trace)
        return {"cpu_ns": time.process_time_ns() - began, "violated": [None] * len(parsed)}

    def _pass_of(self, formula: str) -> tuple[Any, list[tuple[float, list[float]]]]:
        """How a monitor is given a row, and the rows in the order of its names."""
        monitor = self._sentil.OnlineMonitor(self._sentil.parse(formula))
        named = {monitor.symbol_index(name): column for name, column in self._columns.items()}
        own = [named[index] for index in range(monitor.variable_count)]
        rows = [
            (float(tick), [float(value) for value in row])
            for tick, row in enumerate(zip(*own, strict=True))
        ]
        return monitor.update_packed, rows
