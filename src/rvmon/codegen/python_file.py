"""A plan as one Python file that runs alone."""

from __future__ import annotations

import ast
from importlib.resources import files
from itertools import takewhile

from rvmon.automaton.table import tables_of
from rvmon.codegen.c_tables import DECISIONS, VERDICTS, outcomes
from rvmon.codegen.comment import comment
from rvmon.codegen.python_source import judges, unit_source
from rvmon.errors import RvmonError
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.spec.checked.specification import Type
from rvmon.trace.schema import Kind

_RUNTIME = (
    "values",
    "past",
    "table",
    "starts",
    "rule",
    "solo",
    "bulk",
    "timers",
    "nodes",
    "schedule",
    "unit",
    "standalone",
)

_HEADING = (ast.Expr, ast.Import, ast.ImportFrom, ast.If)
"""What stands at the head of a module: its docstring, imports, and those for type checkers."""

_HEAD = '''"""Monitor of the specification {spec}. Generated; it needs Python 3.8 and nothing else.

    monitor = SpecMonitor()
    for attempt in monitor.step(0.5, {{"signal": True}}):      # seconds, and what was updated
        print(attempt.requirement, attempt.number, attempt.verdict)
    print(monitor.finish_ns())                               # verdict by requirement
"""

from __future__ import annotations

import math
from array import array
from bisect import bisect_right
from collections import deque, namedtuple
from heapq import heapify, heappop, heappush, heapreplace
from itertools import product
from operator import add, eq, ge, gt, le, lt, mul, ne, neg, sub, truediv
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    Token = tuple[int, tuple[int, ...]]
    Drive = Callable[[Token, int], tuple[Token, int]]

'''


def python_file(plan: Plan) -> str:
    """The text of a module that judges what a plan holds.

    Raises:
        RvmonError: a requirement has no automaton, or captures values.
    """
    for unit in plan.units:
        raise RvmonError(
            f"{unit.rules[0].requirement.id} captures values (`let`, `for each`), which a Python "
            "file does not: leave it out with --only, or have it evaluated by C (`rvmon build`, "
            "--to c)"
        )
    parts = [_HEAD.format(spec=comment(plan.spec.name))]
    parts += [_body(name) for name in _RUNTIME]
    parts.append(unit_source(plan))
    parts.append("\n\nclass SpecMonitor(Monitor):\n")
    parts.append(f'    """{judges(plan)}"""\n\n')
    parts.append("    UNIT = Generated\n")
    parts.append(f"    NAMES = {tuple(rule.requirement.id for rule in plan.rules)!r}\n")
    parts.append(f"    KINDS = {_kinds(plan)}\n")
    parts.append("    TABLES = (\n")
    parts += [_tables(rule) for rule in plan.judged]
    parts.append("    )\n    OUTCOMES = (\n")
    parts += [f"        {_outcomes(rule)!r},\n" for rule in plan.rules]
    parts.append("    )\n")
    parts.append('\n\nif __name__ == "__main__":\n    print(__doc__)\n')
    return "".join(parts)


def _body(name: str) -> str:
    """A module of the runtime without its docstring and imports."""
    text = files("rvmon.runtime").joinpath(f"{name}.py").read_text(encoding="utf-8")
    head = takewhile(lambda node: isinstance(node, _HEADING), ast.parse(text).body)
    *_, last = head
    text = "".join(text.splitlines(keepends=True)[last.end_lineno :])
    return "\n" + text.strip("\n") + "\n\n\n"


def _tables(rule: PlannedRule) -> str:
    if rule.automaton is None:
        raise RvmonError(
            f"{rule.requirement.id} has no automaton that a Python file can hold, for its attempts "
            "or for those that may be in doubt: leave it out with --only, or have it evaluated by "
            "C (`rvmon build`, --to c)"
        )
    data = tables_of(rule.automaton)
    fields = (
        ("initial location", data.initial),
        ("cuts", data.cuts),
        ("bases", data.bases),
        ("strides", data.strides),
        ("classes of letters", data.class_of),
        ("edges", data.rows),
        ("decided by time", data.time_values),
        ("at the end", data.end_clauses),
    )
    lines = [f"            {value!r},  # {title}\n" for title, value in fields]
    return f"        (  # {comment(rule.requirement.id)}\n{''.join(lines)}        ),\n"


def _outcomes(rule: PlannedRule) -> tuple[tuple[str, str], ...]:
    return tuple(
        (VERDICTS[number & 3].value, DECISIONS[number >> 2].value)
        for number in outcomes(rule.requirement.at_end)
    )


def _kinds(plan: Plan) -> str:
    signals = [f"{name!r}: {_kind(signal.type)}" for name, signal in plan.spec.signals.items()]
    events = []
    for name, event in plan.spec.events.items():
        fields = ", ".join(f"{field!r}: {_kind(type_)}" for field, type_ in event.fields.items())
        events.append(f"{name!r}: {{{fields}}}")
    return f"{{{', '.join([*signals, *events])}}}"


def _kind(type_: Type) -> str:
    if type_.kind is Kind.LABEL:
        return repr(type_.labels)
    return {Kind.BOOL: "bool", Kind.INT: "int", Kind.REAL: "float"}[type_.kind]
