"""What happens at a position, as Python source: nodes in turn, each only if it can have changed."""

from __future__ import annotations

import re
from collections.abc import Iterator

from rvmon.codegen.plan import Plan
from rvmon.codegen.python_nodes import NEVER, NodeWriter, Roles, bits, keeps_stretches

_ARRAYS = ("v", "s", "last", "w", "b", "wakes", "queued", "timers", "since", "until", "before")
"""Attributes of the monitor that statements have at hand under their own name."""

_CONCERNS = ("self.gathered", "self.restless", "self.repeating", "self.dues")
"""If one of these holds, a position is to be judged though no letter changed."""

_STRAIGHT = 40
"""Up to so many nodes stand one after the other; more are looked up by what changed."""

_CONES = 1500
"""So many nodes at most stand in what is written for changes of one leaf."""


def at_hand(lines: list[str], *given: str) -> Iterator[str]:
    """Statements that fetch the arrays which these lines use, but for those given."""
    text = "\n".join(lines)
    for name in _ARRAYS:
        if name not in given and re.search(rf"(?<![\w.]){name}\b", text):
            yield f"{name} = self.{name}"


def indented(lines: Iterator[str] | list[str], depth: int = 1) -> Iterator[str]:
    """Lines of an inner block."""
    return ("    " * depth + line for line in lines)


class VisitWriter:
    """Writes the method that moves a monitor to a position.

    Args:
        plan: what to judge.
        roles: of its nodes.
        nodes: writes their values.
    """

    def __init__(self, plan: Plan, roles: Roles, nodes: NodeWriter) -> None:
        self.plan = plan
        self.roles = roles
        self.nodes = nodes
        self.kept = [place for place in range(len(plan.graph.nodes)) if roles.kept >> place & 1]
        self.straight = len(self.kept) <= _STRAIGHT

    def functions(self) -> Iterator[str]:
        """One function per node, for the first position and for many nodes."""
        for place in self.kept:
            lines = list(self.nodes.statements(place))
            yield f"def n{place}(self, t):"
            yield from indented([*at_hand(lines), *lines, "return n"])
            yield ""
            yield ""

    def sparse(self) -> int:
        """The nodes that have to see every sample where samples are far apart."""
        graph = self.plan.graph
        if self.plan.gap is not None:
            return 0
        return bits(
            tuple(place for place, state in enumerate(graph.nodes) if keeps_stretches(state))
        )

    def span(self) -> int:
        """So far apart samples can be without leaving a hole in a stretch of time."""
        spans = [
            (state.high or 0) - state.low + 1
            for state in self.plan.graph.nodes
            if keeps_stretches(state)
        ]
        return min(spans, default=NEVER)

    def lines(self) -> Iterator[str]:
        """The method `visit`."""
        nodes = list(self._nodes() if self.straight else self._many())
        before = "self.position" if self.plan.gap is None else f"t - {self.plan.gap}"
        yield "def visit(self, t):"
        yield '    """Move to the position at `t`."""'
        yield "    if self.origin is None:"
        yield "        self.start(t)"
        yield "        return"
        yield "    dirty = self.dirty | self.fading"
        yield f"    before = self.before = {before}"
        if self.sparse():
            yield f"    if t - before > {self.span()}:"
            yield f"        dirty |= {self.sparse()}"
        yield "    timers = self.timers"
        yield "    if timers and timers[0][0] <= t:"
        yield "        dirty |= self.ring(t)"
        yield "    fading = letters = triggers = 0"
        yield "    if dirty:"
        yield from indented(at_hand(nodes, "before", "timers"), 2)
        yield from indented(nodes, 2)
        yield "        self.dirty = 0"
        yield "    self.fading = fading"
        yield "    self.position = t"
        asked = ("letters", "triggers", "fading", *_CONCERNS)
        if self.plan.gap is not None and self.plan.gap > 1:
            yield "    self.conclude(t, letters, triggers)"
            return
        yield f"    if {' or '.join(asked)}:"
        yield "        self.conclude(t, letters, triggers)"
        yield "    else:"
        yield f"        self.wake = timers[0][0] if timers else {NEVER}"

    def _nodes(self, places: list[int] | None = None) -> Iterator[str]:
        """Nodes one after the other, by the bits of `dirty`: the n-th bit is the n-th of them."""
        chosen = self.kept if places is None else places
        number = {place: index for index, place in enumerate(chosen)}
        if places is None:
            number = {place: place for place in chosen}
        momentary = bits(
            tuple(place for place, reads in self.plan.graph.reads.items() if reads.momentary)
        )
        for place in chosen:
            bit = 1 << place
            parents = self.roles.parents[place]
            dirty = bits(tuple(number[other] for other in chosen if parents >> other & 1))
            yield f"if dirty & {1 << number[place]}:"
            yield from indented(self.nodes.statements(place))
            if momentary & bit:
                yield f"    if n and self.momentary & {bit}:"
                yield f"        fading |= {bit}"
            yield f"    if n != v[{place}]:"
            if self.roles.letters[place]:
                yield f"        until[{3 * place} + v[{place}]] = before"
                yield f"        since[{place}] = t"
                yield f"        letters |= {self.roles.letters[place]}"
            if self.roles.triggers[place]:
                yield f"        triggers |= {self.roles.triggers[place]}"
            if dirty:
                yield f"        dirty |= {dirty}"
            yield f"        v[{place}] = n"

    def _many(self) -> Iterator[str]:
        yield "cone = self.CONES.get(dirty)"
        yield "if cone is None:"
        yield "    letters, triggers, fading = self.evaluate(t, dirty)"
        yield "else:"
        yield "    letters, triggers, fading = cone(self, t)"

    def cones(self) -> Iterator[str]:
        """For each leaf a function that evaluates it and what depends on it; few have too many."""
        if self.straight:
            return
        found = []
        for place, state in enumerate(self.plan.graph.nodes):
            if state.leaf is not None:
                found.append(self._above(place))
        if sum(map(len, found)) > _CONES:
            found = []
        for places in found:
            lines = list(self._nodes(places))
            yield f"def cone{places[0]}(self, t):"
            yield "    letters = triggers = fading = 0"
            yield "    dirty = 1"
            yield from indented([*at_hand(lines), *lines])
            yield "    return letters, triggers, fading"
            yield ""
        cones = ", ".join(f"{1 << places[0]}: cone{places[0]}" for places in found)
        yield f"CONES = {{{cones}}}"

    def _above(self, place: int) -> list[int]:
        """A node and those whose value depends on it, in order."""
        found = 1 << place
        for other in self.kept:
            if other >= place and found >> other & 1:
                found |= self.roles.parents[other]
        return [other for other in self.kept if found >> other & 1]
