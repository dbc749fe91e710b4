"""rvmon as a contender: specifications as text, through the public interface."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import rvmon

Columns = Mapping[str, list[Any]]


class Rvmon:
    """Answers requests with rvmon's monitors."""

    def __init__(self) -> None:
        self._spec: Any = None
        self._text = self._kind = ""
        self._laid: Any = None
        self._period = self._end = 1

    def load(
        self, spec: str, kind: str, columns: Columns, rows: int, period: int
    ) -> dict[str, Any]:
        """Compile the specification and prepare the rows.

        Args:
            spec: the text; answers are in the order of its requirements.
            kind: `step` (every row complete), `changes` (only changed values) or `evaluate`
                (columns); for robustness `stream`, `attempt` or `offline` (columns).
            columns: the values of each name, one per row.
            rows: their number.
            period: ticks from row to row.
        """
        if spec != self._text:
            self._spec, self._text = rvmon.loads(spec), spec
        self._kind, self._period, self._end = kind, period, rows * period
        if kind in ("evaluate", "offline"):
            import numpy as np

            times = np.arange(rows, dtype=np.int64) * period
            own = {"t_ns": times, **{name: np.array(one) for name, one in columns.items()}}
            self._laid = {name: column[:2] for name, column in own.items()}
            self._ready()()
            self._laid = own
            return {}
        cells = zip(*columns.values(), strict=True)
        whole = [dict(zip(columns, row, strict=True)) for row in cells]
        self._laid = [(t * period, row) for t, row in enumerate(whole)]
        if kind == "changes":
            self._laid[1:] = [
                (t, {name: value for name, value in row.items() if before[name] != value})
                for (t, row), before in zip(self._laid[1:], whole, strict=False)
            ]
        self._spec.monitor()
        return {}

    def run(self) -> dict[str, Any]:
        """One pass over the rows; returns the first row at which each requirement had failed."""
        passed = self._ready()
        began = time.process_time_ns()
        attempts = passed()
        spent = time.process_time_ns() - began
        firsts: dict[str, int | None] = dict.fromkeys(self._spec.requirements)
        for attempt in attempts:
            first = firsts[attempt.requirement]
            if attempt.verdict == "F":  # known at the first row at or after its decision
                row = -(-attempt.decided // self._period)
                firsts[attempt.requirement] = row if first is None else min(first, row)
        return {"cpu_ns": spent, "violated": list(firsts.values())}

    def _ready(self) -> Callable[[], Iterable[Any]]:
        """A function that passes over the rows and returns attempts (none for robustness)."""
        spec, laid, kind = self._spec, self._laid, self._kind
        if kind == "evaluate":
            return lambda: spec.evaluate(laid, time="t_ns").attempts
        if kind == "offline":
            return lambda: spec.robustness(laid, time="t_ns").streams["R1"].low[:0]
        if kind in ("stream", "attempt"):
            measure = spec.robustness_monitor(streams=kind == "stream").step_ns

            def measured() -> Iterable[Any]:
                for t, row in laid:
                    for one in measure(t, row):
                        _ = one.robustness.low  # the figure is created when it is read
                return ()

            return measured
        monitor, fail, end = spec.monitor(), rvmon.Verdict.FAIL, self._end
        step = monitor.step_ns

        def stepped() -> Iterable[Any]:
            failed: list[Any] = []
            for t, row in laid:
                for attempt in step(t, row):
                    if attempt.verdict is fail:
                        failed.append(attempt)  # noqa: PERF401 - as fast as it goes
            return [*failed, *monitor.advance_ns(end)]

        return stepped
