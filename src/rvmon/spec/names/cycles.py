"""Macros and constants that are defined by themselves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rvmon.spec.names.resolved import Declared
from rvmon.spec.rules import names as rules
from rvmon.spec.rules.findings import Findings
from rvmon.spec.syntax.expressions import Call, Expression, Name
from rvmon.spec.syntax.items import ConstItem, DefineItem
from rvmon.spec.syntax.walk import expressions_in


def find_cycles(declared: Mapping[str, Declared], findings: Findings) -> frozenset[str]:
    """The names from which a circle of definitions can be reached; each circle is reported."""
    uses = {
        name: sorted(set(_used(item)) & declared.keys())
        for name, item in declared.items()
        if isinstance(item, DefineItem | ConstItem)
    }
    caught: set[str] = set()
    finished: set[str] = set()
    for root in uses:
        path: list[str] = []
        waiting = [(root, iter(uses[root]))] if root not in finished else []
        while waiting:
            name, rest = waiting[-1]
            if len(path) < len(waiting):
                path.append(name)
            following = next((n for n in rest if n in uses and n not in finished), None)
            if following is None:
                finished.add(name)
                waiting.pop()
                path.pop()
                if caught & set(uses[name]):
                    caught.add(name)
            elif following in path:
                circle = path[path.index(following) :]
                caught.update(circle)
                place = declared[circle[0]].name.span
                findings.add(rules.recursive([*circle, circle[0]], place))
            else:
                waiting.append((following, iter(uses[following])))
    return frozenset(caught)


def _used(item: DefineItem | ConstItem) -> Iterator[str]:
    own: frozenset[str] = frozenset()
    body: Expression = item.value if isinstance(item, ConstItem) else item.body
    if isinstance(item, DefineItem) and item.parameters:
        own = frozenset(parameter.text for parameter in item.parameters)
    for part in expressions_in(body):
        if isinstance(part, Name) and part.text not in own:
            yield part.text
        elif isinstance(part, Call):
            yield part.function.text
