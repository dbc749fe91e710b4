"""Ours, asked as the peers are: specifications as text, through the public interface."""

from __future__ import annotations

import time
from typing import Any

import rvmon


class Peer:
    """Answers requests by rvmon's monitors."""

    def __init__(self) -> None:
        self._spec: Any = None
        self._text = ""
        self._kind = ""
        self._columns: dict[str, list[Any]] = {}
        self._rows: list[tuple[int, dict[str, Any]]] = []
        self._times: Any = None
        self._period = 1

    def load(
        self,
        spec: str,
        kind: str,
        columns: dict[str, list[Any]],
        rows: int,
        period: int = 1,
    ) -> dict[str, Any]:
        """Compile the specification and lay the rows out.

        Args:
            spec: the text; its requirements are answered for in order.
            kind: `step` (every row whole), `changes` (what changed) or `evaluate` (columns); of
                robustness `stream`, `attempt` or `offline` (columns).
            columns: by name the value at each row.
            rows: their number.
            period: ticks from row to row.
        """
        if spec != self._text:
            self._spec, self._text = rvmon.loads(spec), spec
        self._kind, self._period = kind, period
        if kind in ("evaluate", "offline"):
            import numpy as np

            self._columns = {"t_ns": np.arange(rows, dtype=np.int64) * period}
            self._columns |= {name: np.array(column[:rows]) for name, column in columns.items()}
            few = {name: column[:2] for name, column in self._columns.items()}
            self._judge_columns(few)
            return {"rows": rows}
        names = list(columns)
        cells = zip(*(columns[name][:rows] for name in names), strict=True)
        whole = [dict(zip(names, row, strict=True)) for row in cells]
        self._rows = [(t * period, row) for t, row in enumerate(whole)]
        if kind == "changes":
            self._rows = [
                (t, {n: v for n, v in row.items() if i == 0 or whole[i - 1][n] != v})
                for i, (t, row) in enumerate(self._rows)
            ]
        self._spec.monitor()
        return {"rows": rows}

    def run(self) -> dict[str, Any]:
        """One pass over the rows; the first row at which each requirement had failed."""
        if self._kind in ("evaluate", "offline"):
            began = time.process_time_ns()
            attempts = self._judge_columns(self._columns)
            spent = time.process_time_ns() - began
            return {"cpu_ns": spent, "violated": self._violated(attempts)}
        if self._kind in ("stream", "attempt"):
            step = self._spec.robustness_monitor(streams=self._kind == "stream").step_ns
            began = time.process_time_ns()
            for t, row in self._rows:
                for measured in step(t, row):
                    _ = measured.robustness.low  # made when it is read
            return {"cpu_ns": time.process_time_ns() - began, "violated": [None]}
        monitor = self._spec.monitor()
        step = monitor.step_ns
        failed: list[Any] = []
        began = time.process_time_ns()
        fail = rvmon.Verdict.FAIL
        for t, row in self._rows:
            for attempt in step(t, row):
                if attempt.verdict is fail:
                    failed.append(attempt)  # noqa: PERF401 - as fast as it goes
        failed += monitor.advance_ns(len(self._rows) * self._period)
        spent = time.process_time_ns() - began
        return {"cpu_ns": spent, "violated": self._violated(failed)}

    def _judge_columns(self, columns: dict[str, Any]) -> Any:
        """The attempts; of robustness none, but its array is there."""
        if self._kind == "evaluate":
            return self._spec.evaluate(columns, time="t_ns").attempts
        assert len(self._spec.robustness(columns, time="t_ns").streams["R1"])
        return ()

    def _violated(self, attempts: Any) -> list[int | None]:
        """The row at which the failure was known: the first at or after its decision."""
        firsts: dict[str, int | None] = dict.fromkeys(self._spec.requirements)
        for attempt in attempts:
            first = firsts[attempt.requirement]
            if attempt.verdict == "F":
                row = -(-attempt.decided // self._period)
                firsts[attempt.requirement] = row if first is None else min(first, row)
        return list(firsts.values())
