"""What depends on one leaf, as Python source: written out for each value that the leaf can take."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from rvmon.codegen.python_leaves import known_test
from rvmon.codegen.python_nodes import BEFORE, NodeWriter, bits, is_timed
from rvmon.codegen.python_visit import VisitWriter, indented
from rvmon.plan.plan import Plan, asks_knowledge
from rvmon.spec.checked.formula import Constant, SignalAtom

_DEEPEST = 8
"""So many blocks stand within each other at most."""

_MOST = 1500
"""So many nodes at most stand in what is written for changes of one leaf."""


Awaited = tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class _Node:
    """A node, and those behind it in a cone that can change only if it does."""

    place: int
    behind: list[_Node] = field(default_factory=list)


class ConeWriter:
    """Writes functions for changes of a single leaf.

    Args:
        plan: what to judge.
        nodes: writes the values of nodes.
        visit: writes what happens at a position.
    """

    def __init__(self, plan: Plan, nodes: NodeWriter, visit: VisitWriter) -> None:
        self.plan = plan
        self.nodes = nodes
        self.visit = visit
        self.cones = [
            self._above(place)
            for place in nodes.kept
            if (leaf := plan.graph.nodes[place].leaf) is not None and not asks_knowledge(leaf)
        ]
        self.small = sum(map(len, self.cones)) <= _MOST
        self.each = plan.gap in (None, 1)
        """Whether every sample is a position."""
        time_alone = visit.momentary or visit.repeats or not visit.calm
        self.joins = self.each and nodes.watched is None and not time_alone
        """Whether timers that are due are seen to beside a new value, where they do not meet."""
        self.used: dict[str, frozenset[int]] = {}

    def looked_up(self) -> Iterator[str]:
        """Where samples are gathered: a function per leaf, by the bit of it."""
        if self.visit.straight or self.each:
            return
        found = self.cones if self.small else []
        for places in found:
            leaf = places[0]
            yield f"def cone{leaf}(self, t):"
            lines = [*self.nodes.statements(leaf), *self.visit.momentary_lines(leaf)]
            lines += [f"if n == self.v[{leaf}]:", "    return 0, 0, fading"]
            lines += ["if n == 2:", *indented(self._cone([leaf], places, "2"))]
            lines += ["elif n == 0:", *indented(self._cone([leaf], places, "0"))]
            lines += ["else:", *indented(self._cone([leaf], places, "1"))]
            yield "    letters = triggers = fading = 0"
            yield from indented(lines)
            yield "    return letters, triggers, fading"
            yield ""
        listed = ", ".join(f"{1 << places[0]}: cone{places[0]}" for places in found)
        yield f"CONES = {{{listed}}}"

    def followed(self, name: str, kept: Iterator[str]) -> Iterator[str]:
        """What a sample does whose only news is a value `x`.

        Time has changed nothing, or as `dirty` shows, nothing that depends on the value.

        Args:
            name: of the signal.
            kept: what keeps the value.
        """
        leaves, places = self.plan.readers(name), self._cone_of(name)
        lines = list(kept)
        # Few values come to where it is asked for.
        self.nodes.before = self.visit.preceding()
        self.nodes.used.clear()
        for test, value in self._values(leaves[0]):
            lines += [test, *indented(self._moved(leaves, places, value))]
        timed = self.joins or any(is_timed(self.plan.graph.nodes[place]) for place in places)
        triggers = self.joins or any(self.nodes.roles.triggers[place] for place in places)
        lines += self.visit.followed(timed=timed, triggers=triggers)
        self.nodes.before = BEFORE
        self.used[name] = frozenset(self.nodes.used)
        if self.joins:
            yield "letters = triggers = 0"
            yield "if self.dirty:"
            yield f"    self.before = {self.visit.preceding()}"
            yield "    letters, triggers, _ = self.evaluate(t, self.dirty)"
            yield "    self.dirty = 0"
        else:
            yield f"letters = {'triggers = ' if triggers else ''}0"
        yield from lines

    def _values(self, leaf: int) -> Iterator[tuple[str, str]]:
        """The values that a leaf can take, each behind the test of a known `x`."""
        test = known_test(self.plan.graph.nodes[leaf].leaf, "x")
        if test is None:
            yield f"if (n := {self.nodes.formula(leaf)}) == 2:", "2"
            yield "elif n == 0:", "0"
            yield "else:", "1"
        else:
            yield f"if {test}:", "2"
            yield "else:", "0"

    def _moved(self, leaves: Sequence[int], places: list[int], value: str) -> Iterator[str]:
        """What a sample does that may bring leaves another value, the same to all."""
        if self.joins:
            yield f"if self.v[{leaves[0]}] != {value}:"
            yield from indented(self._cone(leaves, places, value))
            return
        if not isinstance(self.plan.graph.nodes[leaves[0]].leaf, SignalAtom):
            yield f"if self.v[{leaves[0]}] == {value}:"
            yield from indented(self.visit.done())
            yield "    return ()"
        yield from self._cone(leaves, places, value)

    def can_follow(self, name: str, instant: frozenset[int]) -> bool:
        """Whether what follows from another value can be written: one atom reads it.

        The atom may stand as several leaves, which differ where the signal is not known only.

        Args:
            name: of a signal.
            instant: the leaves that depend on the present value of one signal and nothing else.
        """
        readers = self.plan.readers(name)
        atoms = {self.plan.graph.nodes[place].leaf for place in readers}
        return self.each and self.small and len(atoms) == 1 and instant.issuperset(readers)

    def apart(self, name: str, near: str) -> str:
        """The condition under which a sample that brings another value of a signal is `followed`.

        Args:
            name: of the signal.
            near: the condition under which no stretch of time has a hole before it; may be empty.
        """
        known = f"self.last{self.plan.signals.index(name)} is not MISSING"
        given = " and ".join(filter(None, [near, known, self._is_grown(name)]))
        if not self.joins:
            return f"t < self.wake and {given}"
        cone = bits(tuple(self._cone_of(name)))
        late = f"t == self.wake < LIMIT and {given} and not self.meets(t, {cone})"
        return f"(t < self.wake or {late}) and {given}"

    def growing(self) -> tuple[tuple[int, Awaited], ...]:
        """What is awaited, as `rvmon.runtime.nodes.Nodes.GROWING` has it."""
        if self.visit.straight:
            return ((1, self._awaited(self.nodes.last)),)
        found = ((self._bit(name), self._awaited(used)) for name, used in self.used.items())
        return tuple((bit, awaited) for bit, awaited in found if awaited)

    def _is_grown(self, name: str) -> str:
        """Whether the nodes have the values that are taken to be theirs; empty: they always do."""
        if self.visit.straight:
            return "self.grown"
        return f"self.grown & {self._bit(name)}" if self._awaited(self.used[name]) else ""

    def _bit(self, name: str) -> int:
        return 1 << self.plan.signals.index(name)

    def _awaited(self, places: Iterable[int]) -> tuple[tuple[int, int], ...]:
        """The values that nodes have to have for these to keep theirs."""
        last = self.nodes.last
        found: set[int] = set()
        stack = list(places)
        while stack:
            place = stack.pop()
            if place in last and place not in found:
                found.add(place)
                stack += self.plan.graph.operands[place]
        return tuple((place, last[place]) for place in sorted(found) if self._varies(place))

    def _varies(self, place: int) -> bool:
        """Whether a node has a value of its own that is not always the same."""
        kept = self.visit.nodes.roles.kept >> place & 1
        return bool(kept) and not isinstance(self.plan.graph.nodes[place].leaf, Constant)

    def _cone_of(self, name: str) -> list[int]:
        readers = self.plan.readers(name)
        return sorted({place for places in self.cones if places[0] in readers for place in places})

    def _cone(self, leaves: Sequence[int], places: list[int], value: str) -> Iterator[str]:
        """What the new value of leaves makes of the nodes above them.

        Args:
            leaves: all of them take the value.
            places: of the leaves and what is above them.
            value: the new one.
        """
        above = [place for place in places if place not in leaves]
        below = {
            place: [other for other in places if self.nodes.roles.parents[other] >> place & 1]
            for place in above
        }
        for leaf in leaves:
            self.nodes.settling(leaf, value)
        written = {place: self._value_of(place) for place in above}
        self.nodes.settled.clear()
        roots = _nested(above, below)
        waiting = [
            root.place
            for root in roots
            if not set(leaves).intersection(below[root.place]) and written[root.place][0]
        ]
        asked = {other for place in waiting for other in below[place]}
        for leaf in leaves:
            yield from self.visit.changed(leaf, value)
        if asked:
            yield f"{' = '.join(f'moved{other}' for other in sorted(asked))} = False"
        for root in roots:
            if root.place in waiting:
                yield f"if {' or '.join(f'moved{other}' for other in below[root.place])}:"
            yield from indented(self._then(root, written, asked), root.place in waiting)

    def _value_of(self, place: int) -> tuple[list[str], str]:
        """The statements that give a node its value, if it needs any, and then what has it."""
        value = self.nodes.expression(place)
        if value is not None and self.nodes.settling(place, value):
            return [], value
        return list(self.nodes.statements(place)), "n"

    def _then(
        self, node: _Node, written: Mapping[int, tuple[list[str], str]], asked: set[int]
    ) -> Iterator[str]:
        """Give a node its value; if that is another one, go on with those behind it."""
        place = node.place
        lines, value = written[place]
        onward = (f"moved{place} = True",) if place in asked else ()
        lines = [*lines, f"if self.v[{place}] != {value}:"]
        lines += indented(self.visit.changed(place, value, onward))
        for other in node.behind:
            lines += indented(self._then(other, written, asked))
        pending = self.nodes.pending(place)
        if pending and value != "2":
            yield f"if {pending}:"
            lines = [*indented(lines)]
        yield from lines

    def _above(self, place: int) -> list[int]:
        """A node and those whose value depends on it, in order."""
        found = 1 << place
        for other in self.nodes.kept:
            if other >= place and found >> other & 1:
                found |= self.nodes.roles.parents[other]
        return [other for other in self.nodes.kept if found >> other & 1]


def _nested(above: Sequence[int], below: Mapping[int, list[int]]) -> list[_Node]:
    """Nodes in their order, each behind the one it depends on if that is the only one.

    Args:
        above: the nodes of a cone but for its leaf.
        below: what they depend on in the cone.
    """
    roots: list[_Node] = []
    path: list[_Node] = []
    for place in above:
        node = _Node(place)
        while path and (below[place] != [path[-1].place] or len(path) > _DEEPEST):
            path.pop()
        (path[-1].behind if path else roots).append(node)
        path.append(node)
    return roots
