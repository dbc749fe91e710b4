"""An over-approximation of the combinations of truth values that inputs can cause.

The value of a formula at one instant depends on *sources*: names, each with a few cases that its
comparisons distinguish, and subformulas with memory or complex comparisons, which are treated as
free. Formulas without a common source are combined freely; others are joined on the cases of their
common sources.
"""

from __future__ import annotations

import operator
from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from functools import cache, reduce
from itertools import product
from math import prod
from typing import Generic, TypeVar

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from rvmon.analysis.representative_inputs import Silence, is_solved, truths_tried, values_of
from rvmon.language.checked.formula import Compare, Constant, EventAtom, SignalAtom
from rvmon.language.checked.specification import CheckedSpec, TimeModel
from rvmon.logic.state_formula import TRUE, Elapsed, Lapsed, Leaf, State, StateOp
from rvmon.logic.state_graph import captured_names, names_of

MOST_COMBINATIONS = 1 << 12
"""The most combinations of a group of formulas, or of all groups; with more, nothing is decided."""

T = TypeVar("T", bound=Hashable)
Truths = tuple[bool, ...]
Source = str | State


def combinations_of(spec: CheckedSpec, states: Sequence[State]) -> frozenset[Truths] | None:
    """The combinations of truth values that state formulas can have at one instant.

    Operators with memory, and comparisons other than of a name with a constant, are treated as
    free. So a combination outside the result is impossible.

    `None` if there are too many combinations.
    """
    table = Letters(spec).table(states, lambda truths: truths)
    return None if table is None else frozenset(table.rows.values())


class Table(Struct, Generic[T], frozen=True):
    """The possible values of a group of formulas, by the cases of its sources."""

    sources: tuple[Source, ...]  # the sources that the formulas depend on
    # per source, the leaves that read it; a subformula with memory is its own leaf
    leaves: tuple[tuple[State, ...], ...]
    # by the truth values of the leaves of each source, the value of the group
    rows: Mapping[tuple[Truths, ...], T]


class Letters:
    """Computes the possible values of groups of formulas, alone and jointly."""

    def __init__(self, spec: CheckedSpec) -> None:
        self.spec = spec
        self._tried = cache(self._found_by_trying)

    def table(self, states: Sequence[State], view: Callable[[Truths], T]) -> Table[T] | None:
        """The possible values of a group, seen through `view`; `None` if there are too many."""
        nodes = _nodes(states)
        leaves = _leaves_by_source(nodes, self.spec)
        shown = [self._shown(source, cases) for source, cases in leaves.items()]
        size = prod(map(len, shown))
        if size > MOST_COMBINATIONS:
            return None
        # Per formula, its truth value in every row.
        values: dict[State, NDArray[np.bool_]] = {}
        for node in nodes:
            if isinstance(node.leaf, Constant):
                values[node] = np.full(size, node.leaf.value)
            elif isinstance(node.leaf, Lapsed) or node.leaf == Elapsed(0):
                # Everything is known here, and the position exists.
                values[node] = np.full(size, node.leaf == Elapsed(0))
        # Rows are numbered as `product` lists them below: the last source changes fastest.
        rest = np.arange(size)
        for read, cases in zip(reversed(leaves.values()), reversed(shown), strict=True):
            rest, case = np.divmod(rest, len(cases))
            values.update(zip(read, np.array(cases).T[:, case], strict=True))
        for node in nodes:
            if not _is_free(node):
                values[node] = _value(node, [values[arg] for arg in node.args])
        columns = np.array([values[state] for state in states]).reshape(len(states), size)
        truths = [*map(tuple, columns.T.tolist())]
        views = {one: view(one) for one in {*truths}}
        rows = dict(zip(product(*shown), map(views.__getitem__, truths), strict=True))
        return Table(tuple(leaves), tuple(leaves.values()), rows)

    def joint(self, tables: Sequence[Table[T] | None]) -> frozenset[tuple[T, ...]] | None:
        """The joint values that several groups can have; `None` if there are too many."""
        known = [table for table in tables if table is not None]
        if len(known) < len(tables):
            return None
        shared = self._shared(known)
        joined: Relation[tuple[T, ...]] = (), {(): {()}}
        for number, table in enumerate(known):
            later = {source for other in known[number + 1 :] for source in other.sources}
            joined = _join(joined, _projected(table, shared), later)
            if sum(map(len, joined[1].values())) > MOST_COMBINATIONS:
                return None
        return frozenset(together for values in joined[1].values() for together in values)

    def _shared(self, tables: Sequence[Table[T]]) -> dict[Source, dict[State, Truths]]:
        """For each source that several tables read, the truth values of each leaf by case."""
        readers: dict[Source, list[tuple[State, ...]]] = defaultdict(list)
        for table in tables:
            for source, group in zip(table.sources, table.leaves, strict=True):
                readers[source].append(group)
        by_source = {}
        for source, groups in readers.items():
            if len(groups) > 1:
                leaves = tuple(dict.fromkeys(leaf for group in groups for leaf in group))
                columns = zip(*self._shown(source, leaves), strict=True)
                by_source[source] = dict(zip(leaves, columns, strict=True))
        return by_source

    def _shown(self, source: Source, leaves: tuple[State, ...]) -> tuple[Truths, ...]:
        """The combinations of truth values that the leaves of a source can have."""
        alone = leaves[0].leaf if len(leaves) == 1 else None
        if not isinstance(source, str) or isinstance(alone, SignalAtom | EventAtom):
            return ((False,), (True,))
        return self._tried(source, leaves)

    def _found_by_trying(self, source: str, leaves: tuple[State, ...]) -> tuple[Truths, ...]:
        conditions = [leaf.leaf for leaf in leaves if leaf.leaf is not None]
        values = values_of(self.spec, conditions, source)
        tried = [{} if isinstance(value, Silence) else {source: value} for value in values]
        valuations = truths_tried(self.spec, conditions, tried)
        return (*dict.fromkeys(tuple(one == TRUE for one in truths) for truths in valuations),)


Relation = tuple[tuple[Source, ...], dict[tuple[int, ...], set[T]]]
"""A tuple of sources, and the possible values of groups by the cases of these sources."""


def _projected(table: Table[T], shared: Mapping[Source, Mapping[State, Truths]]) -> Relation[T]:
    """A table projected onto the cases of the sources that it shares with others."""
    places = [place for place, source in enumerate(table.sources) if source in shared]
    # Per shared source, from the truth values of this table's leaves to the numbers of the joint
    # cases that have them: the leaves of other tables may distinguish more cases.
    cases: list[dict[Truths, list[int]]] = []
    for place in places:
        columns = [shared[table.sources[place]][leaf] for leaf in table.leaves[place]]
        numbers: dict[Truths, list[int]] = defaultdict(list)
        for case, truths in enumerate(zip(*columns, strict=True)):
            numbers[truths].append(case)
        cases.append(numbers)
    views: dict[tuple[Truths, ...], set[T]] = defaultdict(set)
    for chosen, view in table.rows.items():
        views[tuple(chosen[place] for place in places)].add(view)
    rows: dict[tuple[int, ...], set[T]] = {}
    for shown, group_views in views.items():
        for key in product(*(numbers[part] for numbers, part in zip(cases, shown, strict=True))):
            rows[key] = group_views
    return tuple(table.sources[place] for place in places), rows


def _join(
    earlier: Relation[tuple[T, ...]], group: Relation[T], later: set[Source]
) -> Relation[tuple[T, ...]]:
    """Join one more group on the shared sources; only sources read by later groups are kept.

    This is a hash join with projection, as in bucket elimination. A source that no later group
    reads can be dropped, as later joins do not depend on its case. If all sources were kept, each
    group would multiply the number of rows.
    """
    (live, relation), (sources, rows) = earlier, group
    ours = [place for place, source in enumerate(live) if source in sources]
    theirs = [sources.index(live[place]) for place in ours]
    kept = [place for place, source in enumerate(live) if source in later]
    fresh = [p for p, source in enumerate(sources) if source in later and source not in live]
    # The hash table of the join: the group's rows by the cases they share with the relation.
    matches: dict[tuple[int, ...], dict[tuple[int, ...], set[T]]] = {}
    for chosen, views in rows.items():
        rests = matches.setdefault(tuple(chosen[place] for place in theirs), {})
        rests.setdefault(tuple(chosen[place] for place in fresh), set()).update(views)
    joined: dict[tuple[int, ...], set[tuple[T, ...]]] = defaultdict(set)
    for chosen, tuples in relation.items():
        head = tuple(chosen[place] for place in kept)
        for rest, views in matches.get(tuple(chosen[place] for place in ours), {}).items():
            joined[head + rest] |= {(*one, view) for one in tuples for view in views}
    both = (*(live[place] for place in kept), *(sources[place] for place in fresh))
    return both, dict(joined)


def _leaves_by_source(nodes: Iterable[State], spec: CheckedSpec) -> dict[Source, tuple[State, ...]]:
    """The sources of formulas, each with the leaves that read it."""
    leaves: dict[Source, tuple[State, ...]] = {}
    for node in nodes:
        if node.leaf is not None and _is_plain(node.leaf, spec):
            for name in sorted(names_of(node.leaf)):
                leaves[name] = (*leaves.get(name, ()), node)
        elif _is_free(node):
            leaves[node] = (node,)
    return leaves


def _nodes(states: Iterable[State]) -> list[State]:
    """The formulas and their subformulas outside of operators with memory, operands first."""
    nodes: set[State] = set()
    waiting = list(states)
    while waiting:
        node = waiting.pop()
        if node not in nodes:
            nodes.add(node)
            if not _is_free(node):
                waiting.extend(node.args)
    return sorted(nodes, key=lambda node: node.id)


def _is_free(node: State) -> bool:
    """Whether a node is a leaf, has memory, or compares measured windows; it is not split."""
    return node.op not in (StateOp.NOT, StateOp.AND, StateOp.OR, StateOp.SURE)


def _is_plain(leaf: Leaf, spec: CheckedSpec) -> bool:
    """Whether all truth values of a leaf are found by trying values of its names."""
    match leaf:
        case Constant() | SignalAtom() | EventAtom() | Lapsed() | Elapsed(duration=0):
            return True
        case Compare():
            solved = is_solved(leaf) and not captured_names(leaf)
            return solved and all(_is_steady(name, spec) for name in names_of(leaf))
        case _:
            return False


def _is_steady(name: str, spec: CheckedSpec) -> bool:
    """Whether the values tried for a name cover all cases at one position.

    They do not for events with several fields, or if several payloads may share a position.
    """
    if name in spec.signals:
        return True
    several = spec.time is TimeModel.CLOCKED or any(
        requirement.for_each is not None for requirement in spec.requirements.values()
    )
    return len(spec.events[name].fields) == 1 and not several


def _value(node: State, args: Sequence[NDArray[np.bool_]]) -> NDArray[np.bool_]:
    match node.op:
        case StateOp.NOT:
            return ~args[0]
        case StateOp.AND:
            return reduce(operator.and_, args)
        case StateOp.OR:
            return reduce(operator.or_, args)
        case StateOp.SURE:  # nothing is unknown
            return args[0]
        case _:
            raise AssertionError("leaves and operators with memory have a value already")
