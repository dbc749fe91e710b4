"""Which combinations of propositions inputs can bring about; more are allowed, never fewer.

What a formula says at one instant depends on *sources*: names, each of which shows one of a few
values that its comparisons tell apart, and parts that remember or compare in other ways, which are
taken to be true or false at will. Formulas that share no source are combined freely, others join
on what the shared sources show.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Generic, TypeVar, assert_never

from rvmon.analysis.choices import Silence, values_of
from rvmon.analysis.solve import is_solved
from rvmon.dataflow.inputs import Inputs
from rvmon.dataflow.leaves import captured_names, evaluator, reads
from rvmon.formula.state import TRUE, Leaf, State, StateOp
from rvmon.spec.checked import CheckedSpec, Compare, Constant, EventAtom, SignalAtom, TimeModel

MOST_COMBINATIONS = 1 << 12
"""Of more combinations, of one group of formulas or of all together, nothing is said."""

T = TypeVar("T", bound=Hashable)
Truths = tuple[bool, ...]
_Source = str | State
_Shown = Mapping[State, bool]


@dataclass(frozen=True, slots=True)
class Combinations:
    """The truths that some state formulas can have together.

    Attributes:
        vectors: each with a truth per formula; all that inputs can bring about are among them.
    """

    vectors: frozenset[Truths]


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
    found = joint(spec, [states], [lambda truths: truths])
    return None if found is None else Combinations(frozenset(truths for (truths,) in found))


def joint(
    spec: CheckedSpec,
    groups: Sequence[Sequence[State]],
    views: Sequence[Callable[[Truths], T]],
) -> frozenset[tuple[T, ...]] | None:
    """What several groups of state formulas can be together.

    Args:
        spec: declares the names.
        groups: of formulas.
        views: for each group what matters of the truths of its formulas.

    Returns:
        Each with a view per group; `None` if there are too many to look at.
    """
    nodes = [_nodes(states) for states in groups]
    plain = {n for own in nodes for n in own if n.leaf is not None and _is_plain(n.leaf, spec)}
    options = _options(spec, plain)
    relation: dict[tuple[int, ...], set[tuple[T, ...]]] = {(): {()}}
    live: tuple[_Source, ...] = ()
    for number, (states, view) in enumerate(zip(groups, views, strict=True)):
        table = _table(states, nodes[number], plain, options, view)
        if table is None:
            return None
        later = {s for own in nodes[number + 1 :] for s in _sources(own, plain)}
        live, relation = _join(live, relation, table, later)
        if sum(map(len, relation.values())) > MOST_COMBINATIONS:
            return None
    return frozenset(together for found in relation.values() for together in found)


@dataclass(frozen=True, slots=True)
class _Table(Generic[T]):
    """What one group can be, by what its sources show."""

    sources: tuple[_Source, ...]
    rows: Mapping[tuple[int, ...], T]


def _table(
    states: Sequence[State],
    nodes: Sequence[State],
    plain: set[State],
    options: Mapping[str, Sequence[_Shown]],
    view: Callable[[Truths], T],
) -> _Table[T] | None:
    sources = _sources(nodes, plain)
    shown = [_shown(source, options) for source in sources]
    size = 1
    for own in shown:
        size *= len(own)
    if size > MOST_COMBINATIONS:
        return None
    derived = [node for node in nodes if node not in plain and not _is_free(node)]
    rows = {}
    for chosen in product(*(range(len(own)) for own in shown)):
        values: dict[State, bool] = {}
        for own, index in zip(shown, chosen, strict=True):
            values.update(own[index])
        for node in nodes:
            if isinstance(node.leaf, Constant):
                values[node] = node.leaf.value
        for node in derived:
            values[node] = _value(node, values)
        rows[chosen] = view(tuple(values[state] for state in states))
    return _Table(sources, rows)


def _join(
    live: tuple[_Source, ...],
    relation: Mapping[tuple[int, ...], set[tuple[T, ...]]],
    table: _Table[T],
    later: set[_Source],
) -> tuple[tuple[_Source, ...], dict[tuple[int, ...], set[tuple[T, ...]]]]:
    """One group more, joined on the sources it shares; only those used later are kept."""
    common = [source for source in table.sources if source in live]
    ours = [live.index(source) for source in common]
    theirs = [table.sources.index(source) for source in common]
    fresh = [
        place
        for place, source in enumerate(table.sources)
        if source in later and source not in live
    ]
    kept = [place for place, source in enumerate(live) if source in later]
    by_common: dict[tuple[int, ...], dict[tuple[int, ...], set[T]]] = defaultdict(
        lambda: defaultdict(set)
    )
    for chosen, seen in table.rows.items():
        key = tuple(chosen[place] for place in theirs)
        by_common[key][tuple(chosen[place] for place in fresh)].add(seen)
    joined: dict[tuple[int, ...], set[tuple[T, ...]]] = defaultdict(set)
    for chosen, found in relation.items():
        head = tuple(chosen[place] for place in kept)
        for tail, views in by_common[tuple(chosen[place] for place in ours)].items():
            joined[head + tail] |= {(*one, view) for one in found for view in views}
    sources = (*(live[place] for place in kept), *(table.sources[place] for place in fresh))
    return sources, dict(joined)


def _options(spec: CheckedSpec, plain: Iterable[State]) -> dict[str, list[_Shown]]:
    """By name what it can show of the leaves that read it, each once."""
    readers: dict[str, list[State]] = defaultdict(list)
    for node in sorted(plain, key=lambda node: node.id):
        for name in [] if node.leaf is None else reads(node.leaf).names:
            readers[name].append(node)
    return {name: _seen(spec, name, own) for name, own in readers.items()}


def _seen(spec: CheckedSpec, name: str, nodes: Sequence[State]) -> list[_Shown]:
    inputs = Inputs(spec, None)
    leaves = [node.leaf for node in nodes if node.leaf is not None]
    read = [evaluator(leaf, inputs, {}, lambda: 0) for leaf in leaves]
    found = {}
    for value in values_of(spec, leaves, name):
        inputs.forget_occurrences()
        if not isinstance(value, Silence):
            inputs.apply(0, {name: value})
        truths = tuple(evaluate(0) == TRUE for evaluate in read)
        found[truths] = dict(zip(nodes, truths, strict=True))
    return list(found.values())


def _shown(source: _Source, options: Mapping[str, Sequence[_Shown]]) -> Sequence[_Shown]:
    return options[source] if isinstance(source, str) else [{source: False}, {source: True}]


def _sources(nodes: Iterable[State], plain: set[State]) -> tuple[_Source, ...]:
    """What the formulas depend on, in a fixed order."""
    found: dict[_Source, None] = {}
    for node in nodes:
        if node in plain:
            found |= dict.fromkeys(sorted(reads(node.leaf).names) if node.leaf is not None else ())
        elif _is_free(node):
            found[node] = None
    return tuple(found)


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


def _value(node: State, values: Mapping[State, bool]) -> bool:
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
