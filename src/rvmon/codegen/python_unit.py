"""Generated Python in this process."""

from __future__ import annotations

import heapq
import math
import operator
from functools import lru_cache
from types import CodeType
from typing import Any, TypeVar

from rvmon.codegen.python_evaluator import evaluator_source
from rvmon.codegen.python_source import unit_source
from rvmon.plan.plan import Plan
from rvmon.runtime.bulk import BulkRule
from rvmon.runtime.nodes import BUSY, LIMIT, MISSING, Nodes
from rvmon.runtime.past import compared, finite, number
from rvmon.runtime.rule import Rule
from rvmon.runtime.solo import SoloRule
from rvmon.runtime.table import letter_table
from rvmon.runtime.unit import Unit, closures
from rvmon.runtime.values import NEVER

_OPERATIONS = ("lt", "le", "eq", "ne", "ge", "gt", "add", "sub", "mul", "truediv", "neg")
_NAMES: dict[str, Any] = {
    **{name: getattr(operator, name) for name in _OPERATIONS},
    "__name__": "rvmon.generated",
    "math": math,
    "heappush": heapq.heappush,
    "NEVER": NEVER,
    "LIMIT": LIMIT,
    "BUSY": BUSY,
    "MISSING": MISSING,
    "Unit": Unit,
    "Rule": Rule,
    "BulkRule": BulkRule,
    "SoloRule": SoloRule,
    "letter_table": letter_table,
    "closures": closures,
    "compared": compared,
    "finite": finite,
    "number": number,
}
"""What generated code may call."""

Made = TypeVar("Made", bound=Nodes)
MadeUnit = TypeVar("MadeUnit", bound=Unit)


def unit_class(
    plan: Plan,
    arriving: frozenset[str] | None,
    base: type[MadeUnit],
) -> type[MadeUnit]:
    """The class of a plan's generated monitors.

    Args:
        plan: what to judge.
        arriving: the names that have a source; `None`: all.
        base: what it derives from.
    """
    return _made(unit_source(plan, arriving), base)


def evaluator_class(plan: Plan, base: type[Made]) -> type[Made]:
    """A class that evaluates the state formulas of a plan.

    Args:
        plan: has the formulas, and no rules.
        base: what it derives from.
    """
    return _made(evaluator_source(plan), base)


def _made(source: str, base: type[Made]) -> type[Made]:
    namespace = {**_NAMES, "Base": base, "Unit": base}
    exec(_code(source), namespace)  # noqa: S102
    made: type[Made] = namespace["Generated"]
    return made


@lru_cache(maxsize=64)
def _code(source: str) -> CodeType:
    """The source compiled; it holds names and numbers of the specification as literals only.

    Of many recordings the same is asked again and again.
    """
    return compile(source, "<generated monitor>", "exec")
