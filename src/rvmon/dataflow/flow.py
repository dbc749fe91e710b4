"""State formulas over a running input: only what changed is evaluated again."""

from __future__ import annotations

from collections import deque
from collections.abc import Container, Iterable, Mapping
from heapq import heappop, heappush
from typing import assert_never

from rvmon.dataflow.graph import Graph
from rvmon.dataflow.inputs import Inputs, Reported
from rvmon.dataflow.leaves import Evaluate, before_birth, evaluator
from rvmon.dataflow.outages import Outage
from rvmon.dataflow.previous import Hidden, Previous
from rvmon.formula.state import FALSE, TRUE, UNKNOWN, Elapsed, Lapsed, Leaf, State, StateOp
from rvmon.runtime.past import Since
from rvmon.runtime.table import NEVER
from rvmon.spec.checked.formula import Compare, ProbeAtom, SignalAtom
from rvmon.trace.sample import Scalar

Memory = Since | Previous | Hidden


class Flow:
    """The truth of all nodes of a graph at the current position.

    Between two positions at which something is evaluated all values stay as they are;
    `next_change` says when something changes by time alone.

    Args:
        graph: what to evaluate.
        inputs: owned by this flow.
        gap: ticks between two positions; `None` if only samples are positions.
        captured: values of `let` and `for each`.

    Attributes:
        values: per node of the graph.
        origin: the first position; `None` before it.
        position: the position that `values` were evaluated at last.
        since: per node, the position from which on it has had its value.
        memory: what the nodes that look back remember.
        cut: the instant from which on it is not known which values were captured.
        begun: of a flow that was made by `twin`, the position from which on it saw what is its own.
    """

    STATE = (
        *("inputs", "memory", "values", "since", "origin", "position", "_until", "_last"),
        *("_dirty", "_fading", "_wakes", "_left", "cut", "begun"),
    )

    cut = NEVER
    begun: int | None = None

    def __init__(
        self, graph: Graph, inputs: Inputs, gap: int | None, captured: Mapping[str, Scalar]
    ) -> None:
        self.graph = graph
        self.inputs = inputs
        self.gap = gap
        self.captured = captured
        self.values = [UNKNOWN] * len(graph.nodes)
        self.since = [0] * len(graph.nodes)
        self.origin: int | None = None
        self.position = 0
        self._until: dict[tuple[int, int], int] = {}
        self._last = 0
        self._dirty: set[int] = set()
        self._fading: list[int] = []
        self._wakes: dict[int, int] = {}
        self._left = True
        self.memory: dict[int, Memory] = {}
        self._momentary = frozenset(
            place
            for place, reads in graph.reads.items()
            if reads.momentary and not self._is_never(place)
        )
        self._evaluate = [self._evaluator(place) for place in range(len(graph.nodes))]

    def _is_never(self, place: int) -> bool:
        """Whether nothing whose occurrence a leaf speaks of has a source: its value is fixed."""
        needed = self.graph.reads[place].names
        if not isinstance(self.graph.nodes[place].leaf, ProbeAtom):
            needed -= self.inputs.slots.keys()
        return bool(needed) and needed <= self.inputs.absent

    def apply(self, t: int, values: Mapping[str, Reported]) -> None:
        """Take the updates of a sample; they show at the next call of `evaluate`."""
        self._leave()
        self.inputs.apply(t, values)
        for name in values:
            self._dirty.update(self.graph.by_name.get(name, ()))

    def fork(self, graph: Graph, captured: Mapping[str, Scalar]) -> Flow:
        """A flow at the same position for another graph, which sees what occurs there.

        It must not remember anything but by nodes that this one has, too.

        Args:
            graph: of the new flow.
            captured: values of `let` and `for each`.
        """
        made = Flow(graph, self.inputs.copy(), self.gap, captured)
        if self.origin is not None:
            made.origin = self.origin
            made._dirty.update(range(len(graph.nodes)))
            for place, state in enumerate(graph.nodes):
                if state in self.graph.index:
                    made._take_over(place, self)
            made._left = False
            made._last = self._last
            made._settle(self.position)
        return made

    def twin(
        self, captured: Mapping[str, Scalar], varying: Iterable[int], own: Iterable[int]
    ) -> Flow:
        """The same flow with other captured values.

        Args:
            captured: values of `let` and `for each`.
            varying: the nodes that depend on them; none of them remembers anything.
            own: the nodes of which nothing is told that was before.
        """
        made = Flow(self.graph, self.inputs.copy(), self.gap, captured)
        made.begun, made.origin, made.position = self.position, self.origin, self.position
        made.values[:], made.since[:] = self.values, self.since
        made._until, made._wakes = dict(self._until), dict(self._wakes)
        made._dirty, made._fading = set(self._dirty), list(self._fading)
        made._last, made._left = self._last, self._left
        for place, node in self.memory.items():
            _copy_memory(node, made.memory[place])
        if self.origin is not None:
            made._propagate(self.position, set(varying))
            for place in own:
                made.since[place] = self.position
        return made

    def stands_like(self, other: Flow, varying: Container[int]) -> bool:
        """Whether a flow of the same graph, at this instant too, goes on as this one will.

        Args:
            other: that flow.
            varying: the nodes that depend on captured values.
        """
        pairs = zip(self.values, other.values, strict=True)
        if any(one != its and place not in varying for place, (one, its) in enumerate(pairs)):
            return False
        nodes = ((node, other.memory[place]) for place, node in self.memory.items())
        return all(_remembered(one) == _remembered(its) for one, its in nodes)

    @property
    def is_cut(self) -> bool:
        """Whether that instant is set."""
        return self.cut < NEVER

    def cut_at(self, t: int) -> None:
        """Set that instant: the position that it is at, or one to come."""
        self.cut = t
        for place, state in enumerate(self.graph.nodes):
            if isinstance(state.leaf, Lapsed):
                self._set_wake(place, t)
        if self.position == t:
            self._propagate(t, {place for place, wake in self._wakes.items() if wake <= t})

    def _lapsed(self, place: int, t: int) -> int:
        self._set_wake(place, self.cut if t < self.cut else NEVER)
        return FALSE if t < self.cut else TRUE

    def _take_over(self, place: int, other: Flow) -> None:
        """Have a node be, and remember, what it is in another flow."""
        theirs = other.graph.index[self.graph.nodes[place]]
        self.values[place], self.since[place] = other.values[theirs], other.since[theirs]
        if place not in self._momentary:  # those are seen to be over at the next position
            self._dirty.discard(place)
        if theirs in other.memory:
            _copy_memory(other.memory[theirs], self.memory[place])
        if theirs in other._wakes:
            self._wakes[place] = other._wakes[theirs]

    def _leave(self) -> None:
        if self._left:
            self.inputs.forget_occurrences()
            self._left = False

    def evaluate(self, t: int) -> list[int]:
        """Move to the position at `t`; returns the nodes whose value changed."""
        self._leave()
        dirty = self._dirty
        if self.origin is None:
            self.origin = t
            self.since = [t] * len(self.values)
            dirty.update(range(len(self.values)))
        elif self.gap is None:
            dirty.update(self.graph.stateful)
        self._last = self.position if self.gap is None else t - self.gap
        dirty.update(self._fading)
        if self._wakes:
            dirty.update([place for place, wake in self._wakes.items() if wake <= t])
        if self.inputs.next_expiry <= t:
            for name in self.inputs.expire(t):
                dirty.update(self.graph.by_name.get(name, ()))
        return self._settle(t)

    def _settle(self, t: int) -> list[int]:
        """Evaluate what may have changed, at the position at `t`; returns the nodes that did."""
        changed, evaluated = self._propagate(t, self._dirty)
        values = self.values
        self._fading = [place for place in self._momentary & evaluated if values[place] != FALSE]
        self._dirty = set()
        self._left = True
        self.position = t
        return changed

    def _propagate(self, t: int, dirty: set[int]) -> tuple[list[int], set[int]]:
        queue = sorted(dirty)
        values, parents = self.values, self.graph.parents
        changed = []
        while queue:
            place = heappop(queue)
            new = self._evaluate[place](t)
            if new == values[place]:
                continue
            self._until[place, values[place]] = self._last
            self.since[place] = t
            values[place] = new
            changed.append(place)
            for parent in parents[place]:
                if parent not in dirty:
                    dirty.add(parent)
                    heappush(queue, parent)
        return changed, dirty

    def last_with(self, place: int, value: int, t: int) -> int | None:
        """The last position up to `t`, not before the present one, at which a node had a value."""
        return t if self.values[place] == value else self._until.get((place, value))

    @property
    def outages(self) -> Mapping[str, Outage]:
        """By name what is not known now, and since when."""
        return self.inputs.outages

    @property
    def next_change(self) -> int:
        """The first position after this one at which a value can change by time alone."""
        if self.gap is None or self.origin is None:
            return NEVER
        found = self.inputs.next_expiry
        if self._wakes:
            found = min(found, *self._wakes.values())
        if self._fading:
            found = min(found, self.position + self.gap)
        if found >= NEVER:
            return NEVER
        return self.position + -(-(found - self.position) // self.gap) * self.gap

    def _evaluator(self, place: int) -> Evaluate:
        state = self.graph.nodes[place]
        values = self.values
        operands = self.graph.operands[place]
        if state.leaf is not None:
            return self._leaf(place, state.leaf)
        match state.op:
            case StateOp.LEAF:
                raise ValueError("a leaf reads something")
            case StateOp.NOT:
                (operand,) = operands
                return lambda _: TRUE - values[operand]
            case StateOp.AND:
                return lambda _: min([values[operand] for operand in operands])
            case StateOp.OR:
                return lambda _: max([values[operand] for operand in operands])
            case StateOp.SURE:
                (operand,) = operands
                return lambda _: TRUE if values[operand] == TRUE else FALSE
            case StateOp.DOUBT:
                return self._doubt(place, state)
            case StateOp.PREVIOUS:
                return self._previous(place)
            case StateOp.SINCE:
                return self._since(place, state)
            case _:
                assert_never(state.op)

    def _leaf(self, place: int, leaf: Leaf) -> Evaluate:
        if isinstance(leaf, Lapsed):
            return lambda t: self._lapsed(place, t)
        read = evaluator(leaf, self.inputs, self.captured, lambda: self.origin)
        unborn = self.graph.nodes[place].unborn
        if isinstance(leaf, SignalAtom | Compare) and unborn != UNKNOWN:
            return before_birth(leaf, read, self.inputs, unborn)
        if not isinstance(leaf, Elapsed):
            return read

        def elapsed(t: int) -> int:
            value = read(t)
            self._set_wake(place, NEVER if value else (self.origin or 0) + leaf.duration)
            return value

        return elapsed

    def _previous(self, place: int) -> Evaluate:
        node = self.memory[place] = Previous(self.gap or 1)
        (operand,) = self.graph.operands[place]
        values = self.values

        def previous(t: int) -> int:
            value = node.step(t, values[operand])
            self._set_wake(place, node.wake)
            return value

        return previous

    def _doubt(self, place: int, state: State) -> Evaluate:
        node = self.memory[place] = Hidden(state.pulse, state.every, self.gap or 1)
        (operand,) = self.graph.operands[place]
        values = self.values

        def doubt(t: int) -> int:
            value = node.step(t, values[operand])
            self._set_wake(place, node.wake)
            return value

        return doubt

    def _since(self, place: int, state: State) -> Evaluate:
        node = self.memory[place] = Since(state.low, state.high, self.gap or 1)
        left, right = self.graph.operands[place]
        values = self.values

        def since(t: int) -> int:
            value, wake = node.step(t, self._last, values[left], values[right])
            self._set_wake(place, wake)
            return value

        return since

    def _set_wake(self, place: int, wake: int) -> None:
        if wake < NEVER:
            self._wakes[place] = wake
        else:
            self._wakes.pop(place, None)


def _copy_memory(source: object, target: object) -> None:
    for name in type(target).__slots__:  # type: ignore[attr-defined]
        one = getattr(source, name)
        if hasattr(type(one), "__slots__"):
            _copy_memory(one, getattr(target, name))
        else:
            setattr(target, name, deque(map(list, one)) if isinstance(one, deque) else one)


def _remembered(node: object) -> tuple[object, ...]:
    """What a node remembers, by value."""
    found = []
    for name in type(node).__slots__:  # type: ignore[attr-defined]
        one = getattr(node, name)
        found.append(_remembered(one) if hasattr(type(one), "__slots__") else one)
    return tuple(found)
