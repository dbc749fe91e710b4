"""The state formulas of some requirements as one graph with shared nodes, and what leaves read."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from rvmon.logic.state_formula import (
    FALSE,
    TRUE,
    UNKNOWN,
    Elapsed,
    Lapsed,
    Leaf,
    Lost,
    Shown,
    State,
    StateOp,
    Unborn,
    captured_of,
    inputs_of,
)
from rvmon.spec.checked.formula import (
    BoundAtom,
    Compare,
    CompareOp,
    Constant,
    EventAtom,
    ProbeAtom,
    SignalAtom,
)
from rvmon.spec.print.printer import format_formula, format_numeric


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


def leaf_texts(
    roots: Sequence[State], determined: Collection[State]
) -> tuple[tuple[State, str], ...]:
    """The leaves that are read off the input, with their text.

    Of those with one text, which differ in what they are before birth, it is one that goes on
    mattering: the core leaves the others as they were then.

    Args:
        roots: the state formulas that are made of them.
        determined: see `lasting`.
    """
    graph = graph_of(roots)
    last = lasting(graph, roots, determined)
    found: dict[str, State] = {}
    for place, state in enumerate(graph.nodes):
        if isinstance(state.leaf, Shown) and not _is_captured(state.leaf):
            text = _text_of(state.leaf)
            if text not in found or place in last:
                found[text] = state
    return tuple((state, text) for text, state in found.items())


def _is_captured(leaf: Shown) -> bool:
    """Whether it reads nothing but captured values."""
    return isinstance(leaf, Compare) and not inputs_of(leaf.left, leaf.right)


def _text_of(leaf: Shown) -> str:
    """A leaf in the language; what compares a number with itself asks whether that is known."""
    match leaf:
        case Compare(op=CompareOp.EQ, left=left, right=right) if left == right:
            return f"known({format_numeric(left)})"
        case _:
            return format_formula(leaf)


def lasting(graph: Graph, roots: Iterable[State], determined: Collection[State]) -> frozenset[int]:
    """The nodes that matter once every signal is born and every trigger was true or false.

    Args:
        graph: of the roots at least.
        roots: the state formulas that are asked for.
        determined: what is true from then on.
    """
    settled: list[int | None] = []
    for state, operands in zip(graph.nodes, graph.operands, strict=True):
        known = TRUE if state in determined else _settled(state, [settled[one] for one in operands])
        settled.append(known)
    places = (graph.index[state] for state in roots)
    stack = [place for place in places if settled[place] is None]
    needed: set[int] = set()
    while stack:
        place = stack.pop()
        if place not in needed:
            needed.add(place)
            stack += [one for one in graph.operands[place] if settled[one] is None]
    return frozenset(needed)


def _settled(state: State, operands: Sequence[int | None]) -> int | None:
    """The truth that a node has from then on; `None`: it goes on changing."""
    known = [one for one in operands if one is not None]
    match state.op:
        case StateOp.LEAF:
            if isinstance(state.leaf, Constant):
                return TRUE if state.leaf.value else FALSE
            return {Unborn: FALSE, Lost: UNKNOWN}.get(type(state.leaf))
        case StateOp.NOT if known:
            return TRUE - known[0]
        case StateOp.SURE if known:
            return TRUE if known[0] == TRUE else FALSE
        case StateOp.AND if FALSE in known or len(known) == len(operands):
            return min(known)
        case StateOp.OR if TRUE in known or len(known) == len(operands):
            return max(known)
        case _:
            return None


def _all_of(roots: Iterable[State]) -> set[State]:
    """State formulas and all they are made of."""
    seen: set[State] = set()
    stack = list(roots)
    while stack:
        state = stack.pop()
        if state not in seen:
            seen.add(state)
            stack.extend(state.args)
    return seen


def leaf_count(roots: Iterable[State]) -> int:
    """How many leaves of state formulas are read off the input."""
    return sum(isinstance(state.leaf, Shown) for state in _all_of(roots))


def graph_of(roots: Iterable[State]) -> Graph:
    """The graph of state formulas and all they are made of."""
    nodes = tuple(sorted(_all_of(roots), key=lambda state: state.id))
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
        if state.op in (StateOp.PREVIOUS, StateOp.SINCE, StateOp.AMOUNT, StateOp.DOUBT):
            remembers |= place in varies
            stateful.append(place)
        elif isinstance(state.leaf, Elapsed) or state.op is StateOp.PASSED:
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
