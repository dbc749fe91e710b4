"""Which combinations of propositions inputs can bring about; more are allowed, never fewer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import assert_never

from rvmon.analysis.choices import Silence, choices_of
from rvmon.analysis.solve import is_solved
from rvmon.dataflow.inputs import Inputs
from rvmon.dataflow.leaves import captured_names, evaluator, reads
from rvmon.formula.state import TRUE, Leaf, State, StateOp
from rvmon.spec.checked import CheckedSpec, Compare, Constant, EventAtom, SignalAtom, TimeModel

MOST_FREE = 10
"""Parts that are taken to be true or false at will: at most so many, or nothing is said."""

MOST_COMBINATIONS = 1 << 14


@dataclass(frozen=True, slots=True)
class Combinations:
    """The truths that some state formulas can have together.

    Attributes:
        vectors: each with a truth per formula; all that inputs can bring about are among them.
    """

    vectors: frozenset[tuple[bool, ...]]


def combinations_of(spec: CheckedSpec, states: Sequence[State]) -> Combinations | None:
    """The truths that state formulas can have together.

    What remembers, and what compares in other ways than a name with a constant, is taken to be
    true or false at will, so that a combination that is not found is impossible indeed.

    Args:
        spec: declares the names.
        states: any.

    Returns:
        The combinations; `None` if there are too many to look at.
    """
    nodes = _nodes(states)
    plain = [node for node in nodes if node.leaf is not None and _is_plain(node.leaf, spec)]
    free = [node for node in nodes if _is_free(node) and node not in plain]
    leaves = [node.leaf for node in plain if node.leaf is not None]
    names = frozenset().union(*(reads(leaf).names for leaf in leaves))
    choices = choices_of(spec, leaves, names)
    if not choices.complete or len(free) > MOST_FREE:
        return None
    if len(choices.valuations) << len(free) > MOST_COMBINATIONS:
        return None
    inputs = Inputs(spec, None)
    read = [evaluator(leaf, inputs, {}, lambda: 0) for leaf in leaves]
    seen = set()
    for valuation in choices.valuations:
        inputs.forget_occurrences()
        inputs.apply(0, {n: v for n, v in valuation.items() if not isinstance(v, Silence)})
        seen.add(tuple(evaluate(0) == TRUE for evaluate in read))
    vectors = set()
    for truths in seen:
        for chosen in product((False, True), repeat=len(free)):
            values = dict(zip((*plain, *free), (*truths, *chosen), strict=True))
            for node in nodes:
                if node not in values:
                    values[node] = _value(node, values)
            vectors.add(tuple(values[state] for state in states))
    return Combinations(frozenset(vectors))


def _nodes(states: Iterable[State]) -> list[State]:
    """The formulas and what they are made of at one instant, operands first."""
    found: set[State] = set()
    waiting = list(states)
    while waiting:
        node = waiting.pop()
        if node not in found:
            found.add(node)
            if not _is_free(node):
                waiting.extend(node.args)
    return sorted(found, key=lambda node: node.id)


def _is_free(node: State) -> bool:
    """Whether a node is a leaf or remembers."""
    return node.op in (StateOp.LEAF, StateOp.PREVIOUS, StateOp.SINCE)


def _is_plain(leaf: Leaf, spec: CheckedSpec) -> bool:
    """Whether all truths of a leaf are seen by trying values."""
    match leaf:
        case Constant() | SignalAtom() | EventAtom():
            return True
        case Compare():
            solved = is_solved(leaf) and not captured_names(leaf)
            return solved and all(_is_steady(name, spec) for name in reads(leaf).names)
        case _:
            return False


def _is_steady(name: str, spec: CheckedSpec) -> bool:
    """Whether what is tried for a name covers all that it can say at one position.

    Not so for events with many fields, nor where several of their payloads come together.
    """
    if name in spec.signals:
        return True
    several = spec.time is TimeModel.CLOCKED or any(
        requirement.for_each is not None for requirement in spec.requirements.values()
    )
    return len(spec.events[name].fields) == 1 and not several


def _value(node: State, values: dict[State, bool]) -> bool:
    match node.op:
        case StateOp.NOT:
            return not values[node.args[0]]
        case StateOp.AND:
            return all(values[arg] for arg in node.args)
        case StateOp.OR:
            return any(values[arg] for arg in node.args)
        case StateOp.LEAF | StateOp.PREVIOUS | StateOp.SINCE:
            raise AssertionError("leaves and what remembers have a value already")
        case _:
            assert_never(node.op)
