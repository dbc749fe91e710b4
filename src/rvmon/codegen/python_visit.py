"""What happens at a position, as Python source: nodes in turn, each only if it can have changed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rvmon.codegen.python_nodes import NodeWriter, Roles, bits, sparse_nodes, sparse_span
from rvmon.plan.plan import Plan
from rvmon.runtime.values import NEVER
from rvmon.spec.checked.specification import Mode

_STRAIGHT = 40
"""Up to so many nodes stand one after the other; more are looked up by what changed."""


def alone(lines: Iterator[str] | list[str]) -> Iterator[str]:
    """Statements during which no other sample is taken; they stand behind a look at `after`.

    Between the two no function is called, so that no other thread can have a turn.
    """
    yield "held = self.after"
    yield "self.after = BUSY"
    yield "try:"
    yield from indented(lines)
    yield "except BaseException:"
    yield "    self.after = held"
    yield "    self.torn = t"
    yield "    raise"


def indented(lines: Iterator[str] | list[str], depth: int = 1) -> Iterator[str]:
    """Lines of an inner block."""
    return ("    " * depth + line for line in lines)


def is_straight(roles: Roles) -> bool:
    """Whether all nodes stand one after the other in what visits a position."""
    return roles.kept.bit_count() <= _STRAIGHT


class VisitWriter:
    """Writes the method that moves a monitor to a position.

    Args:
        plan: what to judge.
        nodes: writes the values of nodes, whatever was born.
        grown: the same, once all that will have been.
        calm: whether no requirement is ever asked because of time alone.
    """

    def __init__(self, plan: Plan, nodes: NodeWriter, grown: NodeWriter, *, calm: bool) -> None:
        self.plan = plan
        self.nodes = nodes
        self.grown = grown
        self.calm = calm
        self.momentary = bits(
            tuple(place for place, reads in plan.graph.reads.items() if reads.momentary)
        )
        self.gathers = any(uses.history or uses.marked for uses in plan.uses.values()) or any(
            name in plan.uses for name in plan.events
        )
        self.goes_on = any(
            rule.requirement.mode is Mode.WHENEVER and rule.trigger is not None
            for rule in plan.rules
        )
        self.repeats = any(
            rule.requirement.pulse and rule.requirement.mode is not Mode.WHENEVER
            for rule in plan.rules
        )
        self.straight = is_straight(grown.roles)

    def sparse(self) -> int:
        """The nodes that have to see every sample where samples are far apart."""
        return sparse_nodes(self.plan)

    def span(self) -> int:
        """So far apart samples can be without leaving a hole in a stretch of time."""
        return sparse_span(self.plan)

    def lines(self) -> Iterator[str]:
        """The method `visit`."""
        given = "self.dirty | self.fading" if self.momentary else "self.dirty"
        yield "def visit(self, t):"
        yield '    """Move to the position at `t`."""'
        yield "    first = self.origin is None"
        yield "    if first:"
        yield "        self.enter(t)"
        yield f"    dirty = {given}"
        yield f"    self.before = {self.preceding()}"
        if self.sparse():
            yield f"    if t - self.before > {self.span()}:"
            yield f"        dirty |= {self.sparse()}"
        yield from indented(self._rung())
        yield "    fading = letters = triggers = 0"
        yield "    if dirty:"
        yield from indented(self._grown() if self.straight else self._many(), 2)
        yield "        self.dirty = 0"
        yield "    if first:"
        yield f"        letters, triggers = 0, {(1 << len(self.plan.judged)) - 1}"
        yield "        # What nodes were before was at no instant."
        yield "        self.until[:] = [None] * len(self.until)"
        if self.momentary:
            yield "    self.fading = fading"
        yield from indented(self.judged())

    def preceding(self) -> str:
        """The position before."""
        return "self.position" if self.plan.gap is None else f"t - {self.plan.gap}"

    def judged(self) -> Iterator[str]:
        """Have the position judged, if it concerns a requirement."""
        yield "self.position = t"
        if self.plan.gap is not None and self.plan.gap > 1:
            yield "self.conclude(t, letters, triggers)"
            return
        yield from self._concluded([*self._concerns(), *self._timely()])
        yield from self._alarm(self.nodes.watched)

    def followed(self, *, timed: bool, triggers: bool) -> Iterator[str]:
        """As `judged`, where before the sample nothing was awaited at its instant.

        Args:
            timed: whether something may be awaited from now on, though no requirement is concerned.
            triggers: whether one may have been triggered.
        """
        yield "self.position = t"
        yield from self._concluded([*self._concerns(triggers=triggers)], triggers=triggers)
        alarm = list(self._alarm(self.grown.watched))
        if timed or not self.calm:
            yield from indented(alarm)
        elif self.goes_on:
            yield from indented(self._resumption())
        if timed:
            yield "else:"
            yield from indented(alarm)

    def _concluded(self, concerns: list[str], *, triggers: bool = True) -> Iterator[str]:
        yield f"if {' or '.join(concerns)}:"
        how = "conclude"
        if self.calm:
            how = "conclude_alone" if len(self.plan.judged) == 1 else "conclude_calmly"
        yield f"    self.{how}(t, letters, {'triggers' if triggers else 0})"

    def done(self) -> Iterator[str]:
        """Note that a sample was taken."""
        yield "self.after = t"
        if self.plan.gap is None:
            yield "self.position = t"

    def flush(self) -> Iterator[str]:
        """Return what was decided."""
        if self.plan.gap is None:
            yield "self.position = t"
        yield "if self.news:"
        yield "    self.news = False"
        yield "    try:"
        yield "        return self.clerk.flush(t)"
        yield "    except BaseException:"
        yield "        if self.after == BUSY:"
        yield "            self.after = self.torn = t"
        yield "        raise"
        yield "self.after = t"
        yield "return ()"

    def _concerns(self, *, triggers: bool = True) -> Iterator[str]:
        """If none of these holds, a position is not to be judged."""
        alone = len(self.plan.judged) == 1
        yield f"letters and {'' if alone else 'letters & '}self.active"
        if triggers:
            yield "triggers & self.asked" if self.goes_on else "triggers"
        if self.repeats:
            yield "self.repeating"
        if not self.calm:
            yield "self.restless"

    def _timely(self) -> Iterator[str]:
        """Nor if one of these does, which speak of an instant."""
        if self.momentary:
            yield "fading"
        if self.gathers:
            yield "self.gathered"
        if not self.calm:
            yield "(self.dues and self.dues[0][0] <= t)"
        if self.goes_on:
            yield "self.resume_at <= t"

    def _rung(self) -> Iterator[str]:
        """See what time alone has changed."""
        if self.nodes.watched is None:
            yield "if self.timers and self.timers[0][0] <= t:"
            yield "    dirty |= self.ring(t)"
            return
        for place in self.nodes.watched:
            yield f"if self.wakes[{place}] <= t:"
            yield f"    self.wakes[{place}] = {NEVER}"
            yield f"    dirty |= {1 << place}"

    def _alarm(self, watched: Sequence[int] | None) -> Iterator[str]:
        """Work out before when nothing happens; as `Unit.set_alarm`."""
        waiting = ["self.fading"] if self.momentary else []
        if self.repeats:
            waiting.append("self.repeating")
        if self.plan.gap is None and not self.calm:
            waiting.append("self.restless")
        wake = list(self._next_wake(watched))
        if waiting:
            yield f"if {' or '.join(waiting)}:"
            yield "    self.wake = t + 1"
            yield "else:"
        yield from indented(wake, 1 if waiting else 0)
        yield from self._resumption()

    def _resumption(self) -> Iterator[str]:
        """What has failed may go on before anything else happens."""
        if self.goes_on:
            yield "if self.resume_at < self.wake:"
            yield "    self.wake = self.resume_at"

    def _next_wake(self, watched: Sequence[int] | None) -> Iterator[str]:
        if self.calm and watched is not None and len(watched) == 1:
            yield f"wake = self.wakes[{watched[0]}]"
            yield "self.wake = wake if wake < LIMIT else LIMIT"
            return
        yield "wake = LIMIT"
        if watched is None:
            yield "if self.timers and self.timers[0][0] < wake:"
            yield "    wake = self.timers[0][0]"
        for place in watched or ():
            yield f"if self.wakes[{place}] < wake:"
            yield f"    wake = self.wakes[{place}]"
        if not self.calm:
            yield "if self.dues and self.dues[0][0] < wake:"
            yield "    wake = self.dues[0][0]"
        yield "self.wake = wake"

    def watch(self) -> Iterator[str]:
        """The methods that take the place of a queue of timers."""
        watched = self.nodes.watched
        if watched is None:
            return
        yield "def set_wake(self, place, t):"
        yield "    self.wakes[place] = t"
        yield ""
        yield "def next_timer(self):"
        listed = "".join(f", self.wakes[{place}]" for place in watched)
        yield f"    return {f'min(NEVER{listed})' if watched else 'NEVER'}"
        yield ""
        yield "def ring(self, t):"
        yield "    dirty = 0"
        yield from indented(self._rung())
        yield "    return dirty"
        yield ""

    def _grown(self) -> Iterator[str]:
        """Nodes one after the other, by the bits of `dirty`, once they all have grown."""
        yield "if self.grown:"
        yield from indented([*self._nodes()] or ["pass"])
        yield "else:"
        yield "    letters, triggers, fading = self.evaluate(t, dirty)"

    def _nodes(self) -> Iterator[str]:
        for place in self.grown.kept:
            dirty = self.grown.roles.parents[place]
            onward = (f"dirty |= {dirty}",) if dirty else ()
            tests = [f"dirty & {1 << place}", self.grown.pending(place)]
            yield f"if {' and '.join(filter(None, tests))}:"
            yield from indented(self.grown.statements(place))
            yield from indented(self.momentary_lines(place))
            yield f"    if n != self.v[{place}]:"
            yield from indented(self.changed(place, "n", onward), 2)

    def momentary_lines(self, place: int) -> Iterator[str]:
        """Whether a leaf speaks of this position only, behind its statements."""
        if self.momentary >> place & 1:
            yield f"if n and self.momentary & {1 << place}:"
            yield f"    fading |= {1 << place}"

    def changed(self, place: int, value: str, onward: Iterable[str] = ()) -> Iterator[str]:
        """A node has another value: notify whom it concerns.

        Args:
            place: of the node.
            value: the new one.
            onward: notifies the nodes that depend on it.
        """
        alone = len(self.plan.judged) == 1
        sign = "=" if alone else "|="
        if self.nodes.roles.letters[place]:
            yield f"self.until[{3 * place} + self.v[{place}]] = {self.grown.before}"
            yield f"self.since[{place}] = t"
            yield f"letters {sign} {self.nodes.roles.letters[place]}"
        if self.nodes.roles.triggers[place]:
            sign = "=" if alone and not self.goes_on else "|="
            yield f"triggers {sign} {self.nodes.roles.triggers[place]}"
        yield from onward
        yield f"self.v[{place}] = {value}"

    def _many(self) -> Iterator[str]:
        if self.plan.gap in (None, 1):  # a lone value has taken another way
            yield "letters, triggers, fading = self.evaluate(t, dirty)"
            return
        yield "cone = self.CONES.get(dirty)"
        yield "if cone is None:"
        yield "    letters, triggers, fading = self.evaluate(t, dirty)"
        yield "else:"
        yield "    letters, triggers, fading = cone(self, t)"
