"""The state formulas of some requirements as one graph with shared nodes, and what leaves read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import assert_never

from rvmon.formula.numeric import captured_of, inputs_of
from rvmon.formula.state import Elapsed, Lapsed, Leaf, Lost, Shown, State, StateOp, Unborn
from rvmon.spec.checked.formula import (
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    ProbeAtom,
    SignalAtom,
)
from rvmon.spec.print.printer import format_formula


def names_of(leaf: Leaf) -> frozenset[str]:
    """The signals and events whose updates can change a leaf."""
    match leaf:
        case Constant() | Elapsed() | Lost() | Lapsed() | BoundAtom():
            return frozenset()
        case Unborn(signals=signals):
            return frozenset(name for name, _ in signals)
        case SignalAtom(name=name) | EventAtom(name=name) | ProbeAtom(name=name):
            return frozenset({name})
        case Compare(left=left, right=right):
            return inputs_of(left, right)
        case _:
            assert_never(leaf)


def captured_names(leaf: Leaf) -> frozenset[str]:
    """The captured values that a leaf compares with."""
    if isinstance(leaf, Compare):
        return captured_of(leaf.left, leaf.right)
    return frozenset()


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Nodes in an order in which operands come first.

    Attributes:
        nodes: the state formulas.
        index: their places in `nodes`.
        operands: per node the places of its operands.
        parents: per node the places of those it is an operand of.
        by_name: per signal and event, the leaves that read it.
        stateful: the nodes that remember, and those that change by time alone.
        remembers_captured: whether a node that remembers stands above such a leaf.
    """

    nodes: tuple[State, ...]
    index: Mapping[State, int]
    operands: tuple[tuple[int, ...], ...]
    parents: tuple[tuple[int, ...], ...]
    by_name: Mapping[str, tuple[int, ...]]
    stateful: tuple[int, ...]
    remembers_captured: bool


def leaf_texts(graph: Graph) -> tuple[tuple[State, str], ...]:
    """The leaves that are read off the input, with their text."""
    return tuple(
        (state, format_formula(state.leaf))
        for state in graph.nodes
        if isinstance(state.leaf, Shown)
    )


def leaf_count(roots: Iterable[State]) -> int:
    """How many leaves of state formulas are read off the input."""
    seen: set[State] = set()
    stack = list(roots)
    while stack:
        state = stack.pop()
        if state not in seen:
            seen.add(state)
            stack.extend(state.args)
    return sum(isinstance(state.leaf, Shown) for state in seen)


def graph_of(roots: Iterable[State]) -> Graph:
    """The graph of state formulas and all they are made of."""
    seen: set[State] = set()
    stack = list(roots)
    while stack:
        state = stack.pop()
        if state not in seen:
            seen.add(state)
            stack.extend(state.args)
    nodes = tuple(sorted(seen, key=lambda state: state.id))
    index = {state: place for place, state in enumerate(nodes)}
    operands = tuple(tuple(index[arg] for arg in state.args) for state in nodes)
    parents: list[list[int]] = [[] for _ in nodes]
    by_name: dict[str, list[int]] = {}
    stateful: list[int] = []
    varies: set[int] = set()
    remembers = False
    for place, state in enumerate(nodes):
        for operand in dict.fromkeys(operands[place]):
            parents[operand].append(place)
        if state.leaf is not None:
            for name in names_of(state.leaf):
                by_name.setdefault(name, []).append(place)
            if captured_names(state.leaf):
                varies.add(place)
        elif varies.intersection(operands[place]):
            varies.add(place)
        if state.op in (StateOp.PREVIOUS, StateOp.SINCE, StateOp.DOUBT):
            remembers |= place in varies
            stateful.append(place)
        elif isinstance(state.leaf, Elapsed):
            stateful.append(place)
    return Graph(
        nodes,
        index,
        operands,
        tuple(tuple(places) for places in parents),
        {name: tuple(places) for name, places in by_name.items()},
        tuple(stateful),
        remembers,
    )
