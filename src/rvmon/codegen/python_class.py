"""What every generated class says of its nodes and of the values that it takes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rvmon.codegen.python_nodes import (
    NodeWriter,
    Roles,
    bits,
    keeps_stretches,
    memory_before,
    value_before,
)
from rvmon.codegen.python_values import ValueWriter
from rvmon.codegen.python_visit import indented
from rvmon.diagnostics.comment import comment
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import Compare, ProbeAtom, SignalAtom
from rvmon.spec.print.printer import format_formula


def slots(plan: Plan) -> tuple[str, ...]:
    """The attributes that a class has beside those of `Nodes`."""
    return tuple(f"last{signal}" for signal in range(len(plan.signals)))


def node_functions(nodes: NodeWriter) -> Iterator[str]:
    """What the numbers of the leaves stand for; then one function per node."""
    for place, state in enumerate(nodes.plan.graph.nodes):
        if isinstance(state.leaf, SignalAtom | Compare | ProbeAtom):
            yield f"# {place}: {comment(format_formula(state.leaf))}"
    yield ""
    for place in nodes.kept:
        yield f"def n{place}(self, t):"
        yield from indented([*nodes.statements(place), "return n"])
        yield ""
        yield ""


def node_constants(plan: Plan, roles: Roles) -> Iterator[str]:
    """The constants of `Nodes`."""
    nodes, uses = plan.graph.nodes, plan.uses
    readers = {name: bits(places) for name, places in plan.graph.by_name.items()}
    marked = {
        place: (state.low, state.high)
        for place, state in enumerate(nodes)
        if keeps_stretches(state)
    }
    histories = tuple(
        index for index, name in enumerate(plan.signals) if name in uses and uses[name].history
    )
    functions = (f"n{n}" if roles.kept >> n & 1 else "None" for n in range(len(nodes)))
    yield f"SIGNALS = {plan.signals!r}"
    yield f"EVENTS = {plan.events!r}"
    yield f"GAP = {plan.gap!r}"
    yield f"NODES = {len(nodes)}"
    yield f"KEPT = {roles.kept}"
    yield f"EVALUATE = {listed(functions)}"
    yield f"PARENTS = {roles.parents!r}"
    yield f"READERS = { ({name: readers.get(name, 0) for name in plan.signals})!r}"
    yield f"MOMENTARY = {_momentary(plan)!r}"
    yield f"BEFORE = {tuple(map(value_before, nodes))!r}"
    yield f"MEMORY = {tuple(map(memory_before, nodes))!r}"
    yield f"MARKED = {marked!r}"
    yield f"HISTORIES = {histories!r}"


def takes(values: ValueWriter) -> Iterator[str]:
    """By name, what takes a value."""
    names = (*values.plan.signals, *values.plan.events)
    for number, name in enumerate(names):
        lines = ["dirty = 0", *values.taken("x", name), "return dirty"]
        yield f"def take{number}(self, t, x):"
        yield f"    # {name!a}"
        yield from indented(lines)
        yield ""
    yield f"TAKE = {{{', '.join(f'{name!r}: take{n}' for n, name in enumerate(names))}}}"


def listed(parts: Iterable[str]) -> str:
    """A tuple of expressions."""
    return f"({''.join(f'{part}, ' for part in parts)})"


def _momentary(plan: Plan) -> tuple[tuple[int, tuple[str, ...]], ...]:
    """The leaves that speak of one position, with the names of which they need one."""
    return tuple(
        (
            place,
            tuple(
                sorted(
                    name
                    for name in reads.names
                    if name in plan.spec.events
                    or isinstance(plan.graph.nodes[place].leaf, ProbeAtom)
                )
            ),
        )
        for place, reads in plan.graph.reads.items()
        if reads.momentary
    )
