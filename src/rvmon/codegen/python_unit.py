"""A generated Python monitor in this process."""

from __future__ import annotations

import heapq
import math
import operator
from typing import Any

from rvmon.codegen.python_source import unit_source
from rvmon.codegen.unit_plan import Plan
from rvmon.runtime.bulk import BulkRule
from rvmon.runtime.nodes import BUSY, LIMIT, MISSING
from rvmon.runtime.past import compared, finite, number
from rvmon.runtime.rule import Rule
from rvmon.runtime.solo import SoloRule
from rvmon.runtime.table import NEVER, letter_table
from rvmon.runtime.unit import Unit, closures


def unit_class(plan: Plan, arriving: frozenset[str] | None = None) -> type[Unit]:
    """The class of a plan's generated monitors.

    Args:
        plan: what to judge.
        arriving: the names that have a source; default all.
    """
    operations = ("lt", "le", "eq", "ne", "ge", "gt", "add", "sub", "mul", "truediv", "neg")
    namespace: dict[str, Any] = {name: getattr(operator, name) for name in operations}
    namespace |= {
        "__name__": "rvmon.generated",
        "math": math,
        "NEVER": NEVER,
        "LIMIT": LIMIT,
        "BUSY": BUSY,
    }
    namespace |= {"MISSING": MISSING, "Unit": Unit, "heappush": heapq.heappush}
    namespace |= {"Rule": Rule, "BulkRule": BulkRule, "SoloRule": SoloRule}
    namespace |= {"letter_table": letter_table, "closures": closures}
    namespace |= {"compared": compared, "finite": finite, "number": number}
    source = unit_source(plan, arriving)
    # The source holds names and numbers of the specification as literals only.
    exec(compile(source, "<generated monitor>", "exec"), namespace)  # noqa: S102
    made: type[Unit] = namespace["Generated"]
    return made
