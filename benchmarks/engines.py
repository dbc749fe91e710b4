"""The files that each engine consists of, for mutations of it."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "src" / "rvmon"

_FORMULAS = ("formula/*.py",)
_INPUTS = (
    *(
        f"plan/{name}.py"
        for name in ("graph", "inputs", "leaves", "numbers", "outages", "planning")
    ),
    *(f"codegen/{name}.py" for name in ("python_class", "python_evaluator")),
    *("runtime/copies.py", "runtime/nodes.py"),
)
_ATTEMPTS = tuple(
    f"monitor/{name}.py"
    for name in (
        "attempts/attempt_judge",
        "attempts/captured",
        "attempts/instance",
        "attempts/evaluator",
        "attempts/evaluator_classes",
        "attempts/machine_judge",
        "build",
        "compiled/requirement",
        "inputs/health",
        "inputs/validate",
        "online/evaluators",
        "online/monitor",
        "records/ledger",
    )
)
_AUTOMATA = tuple(
    f"automaton/{name}.py" for name in ("construct", "end", "layout", "location", "reduce")
)
_PLANS = ("plan/planning.py",)
_DRIVEN = tuple(
    f"runtime/{name}.py"
    for name in ("past", "rule", "schedule", "starts", "table", "table_machine", "values")
)
_RUNTIME = tuple(
    f"runtime/{name}.py"
    for name in (
        "bulk",
        "nodes",
        "past",
        "rule",
        "schedule",
        "solo",
        "starts",
        "table",
        "table_machine",
        "unit",
        "values",
    )
)
_GENERATED = tuple(f"monitor/online/{name}.py" for name in ("generated", "unit_clerks"))
_PACKING = tuple(
    f"core/{name}.py"
    for name in (
        "atoms",
        "automata",
        "forms",
        "judges",
        "nodes",
        "part",
        "plan",
        "programs",
        "sections",
        "unit",
    )
)
_CORE_MONITORS = tuple(f"monitor/core/{name}.py" for name in ("captured", "monitor", "planned"))

COLUMNS = "columns"
"""Has a test of its own, of recordings."""

ENGINES: dict[str, tuple[str, ...]] = {
    COLUMNS: ("automaton/moves.py", "monitor/columns/*.py"),
    "automaton": (*_FORMULAS, *_INPUTS, *_ATTEMPTS, *_AUTOMATA, *_DRIVEN),
    "progression": (
        *_FORMULAS,
        "automaton/progression.py",
        *_DRIVEN,
        *_ATTEMPTS,
    ),
    "python": (*_PLANS, "codegen/python_*.py", *_RUNTIME, *_GENERATED),
    "c": (*_PLANS, *_PACKING, "core/*.c", "core/module_*.h", *_CORE_MONITORS),
    "network": (
        "dataflow/time_decisions.py",
        "dataflow/at_end.py",
        "dataflow/evaluate.py",
        "dataflow/knowledge.py",
        "dataflow/network.py",
        "dataflow/news.py",
        "dataflow/news_of_past.py",
        "dataflow/news_of_until.py",
        "dataflow/news_of_window.py",
        "dataflow/nodes.py",
        "dataflow/piecewise.py",
        "dataflow/network_plan.py",
        "dataflow/positions.py",
        "dataflow/ranges.py",
        "dataflow/soonest_news.py",
        "dataflow/sweep.py",
        "monitor/attempts/network_judge.py",
        "monitor/attempts/network_letters.py",
        "monitor/reasons/owed_network.py",
    ),
}
"""By engine, patterns of files below the package."""

RELATED = {
    "automaton": ("auto", "progression", "network"),
    "progression": ("auto", "automaton", "network"),
    "network": ("auto",),
    "python": ("auto",),
    "c": ("c rows",),
}
"""By engine, others that have files in common with it, but run other parts of them."""


def files_of(engine: str) -> list[Path]:
    """The files of an engine.

    Raises:
        FileNotFoundError: a file was moved, and is not named here as it is called now.
    """
    found = set()
    for pattern in ENGINES[engine]:
        files = set(PACKAGE.glob(pattern))
        if not files:
            raise FileNotFoundError(f"{PACKAGE / pattern}, which is listed in {__file__}")
        found |= files
    return sorted(found)
