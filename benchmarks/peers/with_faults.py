"""All peers sample by sample, with whatever stamps and values; runs in their environment.

Each sample is answered by itself: by what the peer says at it, or by the error that it raises.
"""

from __future__ import annotations

import logging
import resource
import time
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

Row = Mapping[str, float]


class Peer:
    """Answers requests by the online monitor of the peer that is named."""

    def feed(self, peer: str, formula: str, samples: list[tuple[float, Row]]) -> dict[str, Any]:
        """What the peer says at each sample."""
        update = MAKERS[peer](formula, sorted({name for _, row in samples for name in row}))
        said = []
        for t, row in samples:
            try:
                said.append(update(t, row))
            except Exception as error:  # noqa: BLE001 - whatever a peer raises is its answer
                said.append(f"{type(error).__name__}: {error}".splitlines()[0][:160])
        return {"said": said}

    def many(self, peer: str, formula: str, count: int) -> dict[str, Any]:
        """One monitor for each of so many keys, each told of two samples."""
        before, began = resident_kib(), time.process_time()
        kept = []
        for _ in range(count):
            update = MAKERS[peer](formula, ["v_x"])
            update(0.0, {"v_x": 1.0})
            update(1.0, {"v_x": 0.0})
            kept.append(update)
        spent = time.process_time() - began
        return {"seconds": spent, "kib": resident_kib() - before}


def resident_kib() -> int:
    """The memory of this process that is in use, now; Linux says so."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() // 1024


Update = Callable[[float, Row], object]


def _rtamt_discrete(formula: str, names: list[str]) -> Update:
    spec = _declared(import_module("rtamt").StlDiscreteTimeOnlineSpecification(), formula, names)
    return lambda t, row: spec.update(t, list(row.items()))


def _rtamt_dense(formula: str, names: list[str]) -> Update:
    spec = _declared(import_module("rtamt").StlDenseTimeOnlineSpecification(), formula, names)
    return lambda t, row: spec.update(*([name, [[t, value]]] for name, value in row.items()))


def _declared(spec: Any, formula: str, names: list[str]) -> Any:
    logging.disable(logging.WARNING)  # it warns of every variable
    for name in {*names, *(word for word in ("v_x", "v_y") if word in formula)}:
        spec.declare_var(name, "float")
    spec.spec = formula
    spec.parse()
    spec.pastify()
    return spec


def _reelay(formula: str, names: list[str]) -> Update:  # noqa: ARG001 - it finds them
    monitor = import_module("reelay").dense_timed_monitor(pattern=formula)
    return lambda t, row: [
        [one["time"], one["value"]] for one in monitor.update({"time": t, **row})
    ]


def _mstlo(formula: str, names: list[str]) -> Update:  # noqa: ARG001 - it finds them
    mstlo = import_module("mstlo_python")
    monitor = mstlo.Monitor(mstlo.parse_formula(formula), semantics="DelayedQualitative")
    return lambda t, row: [
        list(one)
        for name, value in row.items()
        for one in monitor.update(name, value, t).verdicts()
    ]


def _sentil(formula: str, names: list[str]) -> Update:  # noqa: ARG001 - it finds them
    sentil = import_module("sentil")
    monitor = sentil.OnlineMonitor(sentil.parse(formula))
    order = {monitor.symbol_index(name): name for name in ("v_x", "v_y") if name in formula}

    def update(t: float, row: Row) -> object:
        found = monitor.update_packed(t, [row[order[k]] for k in range(monitor.variable_count)])
        return {"from": found.lower, "to": found.upper}

    return update


MAKERS = {
    "rtamt, discrete online": _rtamt_discrete,
    "rtamt, dense online": _rtamt_dense,
    "reelay, dense": _reelay,
    "mstlo": _mstlo,
    "SENTIL, online": _sentil,
}
