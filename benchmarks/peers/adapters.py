"""Adapters of the peers: one class for each, run in a separate process.

A class judges a formula at every tick (`judge`), and prepares a pass over rows in the format of the
peer (`ready`). It runs in the separate environment of the peers, and so imports nothing of this
package.
"""

from __future__ import annotations

import logging
import re
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from typing import Any

Columns = Mapping[str, list[Any]]
Pass = Callable[[], float | None]
"""A pass over all rows; returns the first at which the formula was false."""


class Adapter(ABC):
    """The common part of all adapters."""

    package: str

    def __init__(self) -> None:
        logging.disable(logging.WARNING)  # rtamt warns about every variable
        self.peer: Any = import_module(self.package)
        self._loaded: tuple[list[str], str, Any] = [], "", None

    @abstractmethod
    def judge(self, formula: str, kind: str, columns: Columns) -> dict[str, Any]:
        """The verdict or the robustness at every tick."""

    @abstractmethod
    def laid(self, columns: Columns) -> Any:
        """The rows in the format of this peer."""

    @abstractmethod
    def ready(self, formula: str, kind: str, laid: Any) -> Pass:
        """Make a monitor, and return a pass of it over the rows."""

    def load(self, formulas: list[str], kind: str, columns: Columns) -> dict[str, Any]:
        """Store the formulas and the rows of the next passes."""
        self._loaded = formulas, kind, self.laid(columns)
        return {}

    def run(self) -> dict[str, Any]:
        """One pass over the rows for each formula; only the loops are timed."""
        formulas, kind, laid = self._loaded
        spent, violated = 0, list[float | None]()
        for formula in formulas:
            passed = self.ready(formula, kind, laid)
            began = time.process_time_ns()
            violated.append(passed())
            spent += time.process_time_ns() - began
        return {"cpu_ns": spent, "violated": violated}


def rows_of(columns: Columns, number: Callable[[Any], Any] = lambda cell: cell) -> list[Any]:
    cells = zip(*columns.values(), strict=True)
    return [dict(zip(columns, map(number, row), strict=True)) for row in cells]


def per_tick(changes: Iterable[Sequence[Any]], ticks: int) -> list[Any]:
    """The value at each tick from changes that hold until the next; `None` before the first."""
    values: list[Any] = [None] * ticks
    for instant, value in changes:
        for tick in range(ticks):
            if tick >= instant:
                values[tick] = value
    return values


class Reelay(Adapter):
    """reelay's Python package: past formulas; discrete (one position per update) and dense time."""

    package = "reelay"

    def judge(self, formula: str, kind: str, columns: Columns) -> dict[str, Any]:
        """The verdict, or the robustness if `kind` names it; `dense sparse` passes only changes."""
        model, _, semantics = kind.partition(" ")
        how = {"pattern": formula, "semantics": semantics.replace("sparse", "") or "boolean"}
        rows = rows_of(columns, float) if semantics == "robustness" else rows_of(columns)
        if model == "discrete":
            monitor = self.peer.discrete_timed_monitor(condense=False, **how)
            return {"values": [monitor.update(row)["value"] for row in rows]}
        monitor, changes, ticks = self.peer.dense_timed_monitor(**how), [], len(rows)
        # Pass every tick, also without a change: for a longer stretch that starts and ends true,
        # and is false in between, the Python package does not return the changes.
        for tick, row in enumerate([*rows, rows[-1]]):
            if semantics != "sparse" or row != rows[tick - 1] or tick in (0, ticks):
                changes += monitor.update({"time": tick, **row})
        return {"values": per_tick(((one["time"], one["value"]) for one in changes), ticks)}

    def laid(self, columns: Columns) -> list[Any]:
        return rows_of(columns)

    def ready(self, formula: str, kind: str, laid: list[Any]) -> Pass:
        """In discrete time."""
        update = self.peer.discrete_timed_monitor(pattern=formula, condense=False).update

        def passed() -> float | None:
            first = None
            for row in laid:
                if not update(row)["value"] and first is None:
                    first = row
            return next((number for number, row in enumerate(laid) if row is first), None)

        return passed


class Rtamt(Adapter):
    """rtamt: discrete (one position per sample) and dense time.

    The sign of the robustness is the verdict. Online, it answers for the instant one horizon ago.
    """

    package = "rtamt"

    def _specified(self, which: str, formula: str, names: Iterable[str]) -> Any:
        spec = getattr(self.peer, f"Stl{which}Specification")()
        for name in sorted({*names, *re.findall(r"v_\w+", formula)}):
            spec.declare_var(name, "float")
        spec.spec = formula
        spec.parse()
        if which.endswith("Online"):
            spec.pastify()
        return spec

    def judge(self, formula: str, kind: str, columns: Columns) -> dict[str, Any]:
        """The robustness at every tick; offline, or sample by sample."""
        ticks = len(next(iter(columns.values())))
        if kind == "discrete online":
            update = self._specified("DiscreteTimeOnline", formula, columns).update
            return {"values": [update(tick, row) for tick, row in self.laid(columns)]}
        if kind == "dense online":
            update = self._specified("DenseTimeOnline", formula, columns).update
            rows = self.laid(columns)
            said = [update(*([name, [[tick, x]]] for name, x in row)) for tick, row in rows]
            return {"values": per_tick([one for changes in said for one in changes], ticks)}
        if kind == "discrete":
            spec = self._specified("DiscreteTime", formula, columns)
            numbers = {name: [*map(float, column)] for name, column in columns.items()}
            answer = spec.evaluate({"time": list(range(ticks)), **numbers})
            return {"values": [value for _, value in answer]}
        spec = self._specified("DenseTime", formula, columns)
        changes = [
            [name, [
                [tick, float(value)]
                for tick, value in enumerate(column)
                if tick in (0, ticks - 1) or value != column[tick - 1]
            ]]
            for name, column in columns.items()
        ]  # fmt: skip
        return {"values": per_tick(spec.evaluate(*changes), ticks)}

    def laid(self, columns: Columns) -> list[Any]:
        return [(t, list(row.items())) for t, row in enumerate(rows_of(columns, float))]

    def ready(self, formula: str, kind: str, laid: list[Any]) -> Pass:
        """In discrete time, online."""
        names = [name for name, _ in laid[0][1]]
        update = self._specified("DiscreteTimeOnline", formula, names).update

        def passed() -> float | None:
            first = None
            for t, row in laid:
                if update(t, row) < 0 and first is None:
                    first = t
            return first

        return passed


class Mstlo(Adapter):
    """mstlo: bounded future formulas over dense time, signals held between their samples."""

    package = "mstlo_python"

    def _monitor(self, formula: str, kind: str) -> Any:
        return self.peer.Monitor(self.peer.parse_formula(formula), semantics=kind)

    def judge(self, formula: str, kind: str, columns: Columns) -> dict[str, Any]:
        """The verdict at every tick up to the last one, in the semantics that `kind` names."""
        monitor, rows = self._monitor(formula, kind), rows_of(columns, float)
        known = monitor.get_signal_identifiers()
        verdicts: dict[float, Any] = {}
        for tick, row in enumerate(rows):
            is_whole = tick in (0, len(rows) - 1)
            for name, value in row.items():
                if name in known and (is_whole or value != rows[tick - 1][name]):
                    verdicts.update(monitor.update(name, value, float(tick)).verdicts())
        last = int(max(verdicts, default=-1)) + 1
        return {"values": per_tick(sorted(verdicts.items()), last) + [None] * (len(rows) - last)}

    def laid(self, columns: Columns) -> list[Any]:
        """One call for each signal and row."""
        rows = enumerate(rows_of(columns, float))
        return [(name, value, float(t)) for t, row in rows for name, value in row.items()]

    def ready(self, formula: str, kind: str, laid: list[Any]) -> Pass:
        """In the semantics that `kind` names."""
        monitor = self._monitor(formula, kind)
        update, known = monitor.update, monitor.get_signal_identifiers()
        calls = [call for call in laid if call[0] in known]

        def passed() -> float | None:
            first = None
            for name, value, t in calls:
                for instant, verdict in update(name, value, t).verdicts():
                    if not verdict and (first is None or instant < first):
                        first = instant
            return first

        return passed


class Sentil(Adapter):
    """SENTIL: formulas over samples a tick apart, judged by their robustness."""

    package = "sentil"

    def judge(self, formula: str, kind: str, columns: Columns) -> dict[str, Any]:
        """The robustness at every tick; windows are truncated at the end of the trace."""
        trace = self._trace(columns)
        return {"values": list(self.peer.parse(formula).robustness_signal(trace))}

    def _trace(self, columns: Columns) -> Any:
        ticks = range(len(next(iter(columns.values()))))
        named = {name: [*map(float, column)] for name, column in columns.items()}
        return self.peer.Trace([*map(float, ticks)], named)

    def laid(self, columns: Columns) -> Columns:
        return columns

    def ready(self, formula: str, kind: str, laid: Columns) -> Pass:
        """Online, or offline if `kind` says so; offline no violations are returned."""
        if kind.endswith("offline"):
            signal, trace = self.peer.parse(formula).robustness_signal, self._trace(laid)
            # Warm up: initialisation in the first call is not measured.
            signal(self._trace({name: column[:1] for name, column in laid.items()}))

            def measured() -> None:
                signal(trace)

            return measured
        monitor = self.peer.OnlineMonitor(self.peer.parse(formula))
        named = {monitor.symbol_index(name): name for name in set(re.findall(r"v_\w+", formula))}
        order, update = sorted(named), monitor.update_packed
        cells = zip(*(map(float, laid[named[k]]) for k in order), strict=True)
        rows = [(float(t), list(row)) for t, row in enumerate(cells)]

        def passed() -> float | None:
            first = None
            for t, row in rows:
                if update(t, row).upper < 0 and first is None:
                    first = t
            return first

        return passed
