"""What depends on one leaf, as Python source: written out for each value that the leaf can take."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.codegen.plan import Plan
from rvmon.codegen.python_leaves import known_test
from rvmon.codegen.python_nodes import NodeWriter, Roles, bits
from rvmon.codegen.python_visit import VisitWriter, at_hand, indented
from rvmon.spec.checked import SignalAtom

_MOST = 1500
"""So many nodes at most stand in what is written for changes of one leaf."""


class ConeWriter:
    """Writes functions for changes of a single leaf.

    Args:
        plan: what to judge.
        roles: of its nodes.
        nodes: writes their values.
        visit: writes what happens at a position.
    """

    def __init__(self, plan: Plan, roles: Roles, nodes: NodeWriter, visit: VisitWriter) -> None:
        self.plan = plan
        self.roles = roles
        self.nodes = nodes
        self.visit = visit
        self.cones = [
            self._above(place)
            for place, state in enumerate(plan.graph.nodes)
            if state.leaf is not None
        ]
        self.small = sum(map(len, self.cones)) <= _MOST
        self.each = plan.gap in (None, 1)
        """Whether every sample is a position."""
        time_alone = visit.momentary or visit.repeats or not visit.calm
        self.joins = self.each and nodes.watched is None and not time_alone
        """Whether timers that are due are seen to beside a new value, where they do not meet."""

    def looked_up(self) -> Iterator[str]:
        """Where samples are gathered: a function per leaf, by the bit of it."""
        if self.visit.straight or self.each:
            return
        found = self.cones if self.small else []
        for places in found:
            leaf = places[0]
            yield f"def cone{leaf}(self, t):"
            lines = [*self.nodes.statements(leaf), *self.visit.momentary_lines(leaf)]
            lines += [f"if n == v[{leaf}]:", "    return 0, 0, fading"]
            lines += ["if n == 2:", *indented(self._cone(places, "2"))]
            lines += ["elif n == 0:", *indented(self._cone(places, "0"))]
            lines += ["else:", *indented(self._cone(places, "1"))]
            yield "    letters = triggers = fading = dirty = 0"
            yield from indented([*at_hand(lines), *lines])
            yield "    return letters, triggers, fading"
            yield ""
        listed = ", ".join(f"{1 << places[0]}: cone{places[0]}" for places in found)
        yield f"CONES = {{{listed}}}"

    def followed(self, name: str, kept: Iterator[str]) -> Iterator[str]:
        """What a sample does whose only news is a value `x`.

        Time has changed nothing, or as `dirty` tells, nothing that depends on the value.

        Args:
            name: of the signal.
            kept: what keeps the value.
        """
        places = self._cone_of(name)
        lines = list(kept)
        for test, value in self._values(places[0]):
            lines += [test, *indented(self._moved(places, value))]
        timed = self.joins or any(self.nodes.is_timed(place) for place in places)
        lines += self.visit.followed(timed=timed)
        if "before" in "\n".join(lines):
            yield f"before = {self.visit.preceding()}"
        if self.joins:
            yield "letters = triggers = 0"
            yield "if self.dirty:"
            yield f"    self.before = {self.visit.preceding()}"
            yield "    letters, triggers, _ = self.evaluate(t, self.dirty)"
            yield "    self.dirty = 0"
            yield "dirty = 0"
        else:
            yield "letters = triggers = dirty = 0"
        yield from at_hand(lines, "before", "dues")
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

    def _moved(self, places: list[int], value: str) -> Iterator[str]:
        """What a sample does that may bring a leaf another value."""
        if self.joins:
            yield f"if v[{places[0]}] != {value}:"
            yield from indented(self._cone(places, value))
            return
        if not isinstance(self.plan.graph.nodes[places[0]].leaf, SignalAtom):
            yield f"if v[{places[0]}] == {value}:"
            yield from indented(self.visit.done())
            yield "    return ()"
        yield from self._cone(places, value)

    def can_follow(self, name: str, instant: frozenset[int]) -> bool:
        """Whether what follows from another value can be written: it is read by one leaf.

        Args:
            name: of a signal.
            instant: the leaves that depend on the present value of one signal and nothing else.
        """
        readers = self.plan.graph.by_name.get(name, ())
        return self.each and self.small and len(readers) == 1 and instant.issuperset(readers)

    def apart(self, name: str, quiet: str) -> str:
        """The condition under which a sample that brings another value of a signal is `followed`.

        Args:
            name: of the signal.
            quiet: the condition under which nothing but a new value can change anything.
        """
        if not self.joins:
            return quiet
        cone = bits(tuple(self._cone_of(name)))
        late = quiet.replace("t < self.wake", "t <= self.wake", 1)
        return f"{late} and not (t == self.wake and self.meets(t, {cone}))"

    def _cone_of(self, name: str) -> list[int]:
        (leaf,) = self.plan.graph.by_name[name]
        (places,) = (places for places in self.cones if places[0] == leaf)
        return places

    def _cone(self, places: list[int], value: str) -> Iterator[str]:
        """What the new value of a leaf makes of the nodes above it."""
        nodes = self.nodes
        leaf, *above = places
        number = {place: index for index, place in enumerate(places)}
        nodes.settling(leaf, value)
        yield from self.visit.changed(leaf, value, 0)
        sure = 1 << leaf
        for place in above:
            parents = self.roles.parents[place]
            dirty = bits(tuple(number[other] for other in above if parents >> other & 1))
            reached = any(
                sure >> below & 1 and self.roles.parents[below] >> place & 1 for below in places
            )
            lines = list(nodes.statements(place))
            if len(lines) == 1 and nodes.settling(place, lines[0].removeprefix("n = ")):
                yield f"if v[{place}] != {nodes.settled[place]}:"
                yield from indented(self.visit.changed(place, nodes.settled[place], dirty))
                continue
            lines += [f"if n != v[{place}]:", *indented(self.visit.changed(place, "n", dirty))]
            if not reached:
                yield f"if dirty & {1 << number[place]}:"
            yield from indented(lines, 0 if reached else 1)
        nodes.settled.clear()

    def _above(self, place: int) -> list[int]:
        """A node and those whose value depends on it, in order."""
        found = 1 << place
        for other in self.visit.kept:
            if other >= place and found >> other & 1:
                found |= self.roles.parents[other]
        return [other for other in self.visit.kept if found >> other & 1]
