"""The rules of a network for single clock valuations, with exact rational times.

This implements the semantics a second time, without zones, so that every run of the checker is
verified by code that shares nothing with the search.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from operator import ge, gt, le, lt
from typing import Any, TypeVar

from rvmon.errors import ModelError
from rvmon.models.network import Edge, Guard, Network
from rvmon.models.network import expressions as ex
from rvmon.models.network.evaluate import Frame, evaluator, runner, slot_evaluator
from rvmon.models.runs import Action, Run

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Configuration:
    """Locations, variables and exact clock values."""

    locations: tuple[int, ...]
    values: tuple[int, ...]
    clocks: tuple[Fraction, ...]


class InvalidRunError(AssertionError):
    """A run breaks a rule of the network."""


class _FailedUpdateError(InvalidRunError):
    """An update of a taken edge has no value."""


def initial_configuration(network: Network) -> Configuration:
    """The initial configuration of every run."""
    return Configuration(
        tuple(automaton.initial for automaton in network.automata),
        tuple(variable.initial for variable in network.variables),
        (Fraction(0),) * len(network.clocks),
    )


_COMPARES: dict[ex.ClockOp, Callable[[Fraction, int], bool]] = {
    ex.ClockOp.LT: lt, ex.ClockOp.LE: le, ex.ClockOp.GE: ge, ex.ClockOp.GT: gt,
}  # fmt: skip


class Rules:
    """The rules of one network. Each expression is compiled once."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._ready: dict[int, tuple[object, Callable[..., Any]]] = {}

    def value(self, now: Configuration, expression: ex.Expression) -> int:
        """The value of an expression without clocks."""
        return int(self._compiled(expression, evaluator)(now.locations, now.values))

    def _compiled(self, what: T, make: Callable[[T], Callable[..., Any]]) -> Callable[..., Any]:
        known = self._ready.get(id(what))  # `what` is kept, so that its id stays unique
        if known is None:
            known = self._ready[id(what)] = (what, make(what))
        return known[1]

    def wait(self, now: Configuration, delay: Fraction) -> Configuration:
        """Let time pass.

        Raises:
            InvalidRunError: time may not pass for so long.
        """
        if delay < 0:
            raise InvalidRunError("time goes backwards")
        clocks = tuple(clock + delay for clock in now.clocks)
        later = Configuration(now.locations, now.values, clocks)
        if delay > 0 and self.stops_time(now):
            raise InvalidRunError("time passes in an urgent state")
        self._check_invariants(later)
        return later

    def act(self, now: Configuration, action: Action) -> Configuration:
        """Take the edges of an action together.

        Raises:
            InvalidRunError: they cannot be taken together here.
        """
        after = self._taken(now, action)
        if self._network.priorities is not None:
            own = self._rank(now, action)
            for other in self.every_action(now):
                if self._rank(now, other) > own and self._is_possible(now, other):
                    raise InvalidRunError("a step of higher priority can be taken")
        return after

    def every_action(self, now: Configuration) -> Iterator[Action]:
        """All candidates: internal edges, and senders with any choice of possible receivers."""
        edges = list(self._ready_edges(now))
        for sender, first in edges:
            if first.sync is None:
                yield Action(((sender, first),))
            elif first.sync.sends:
                channel = self.channel_index(now, first)
                choices: dict[int, list[tuple[int, Edge] | None]] = {}
                for other, edge in edges:
                    if other != sender and self._receives(now, edge, channel):
                        choices.setdefault(other, [None]).append((other, edge))
                for chosen in product(*choices.values()):
                    yield Action(((sender, first), *filter(None, chosen)))

    def stops_time(self, now: Configuration) -> bool:
        """Whether an urgent or committed location or an urgent channel stops time."""
        kinds = (
            automaton.locations[place].kind
            for automaton, place in zip(self._network.automata, now.locations, strict=True)
        )
        if any(kind is not ex.LocationKind.NORMAL for kind in kinds):
            return True
        for automaton, edge in self._ready_edges(now):
            if edge.sync is None or not edge.sync.sends:
                continue
            channel = self._network.channels[self.channel_index(now, edge)]
            if channel.urgent and (
                channel.broadcast or self._receivers(now, automaton, self.channel_index(now, edge))
            ):
                return True
        return False

    def is_ready(self, now: Configuration, automaton: int, edge: Edge) -> bool:
        """Whether an edge starts at the current location and its guard on the variables holds."""
        here = now.locations[automaton] == edge.source
        return here and bool(self.value(now, edge.guard.data))

    def channel_index(self, now: Configuration, edge: Edge) -> int:
        """The index of the channel that an edge uses, given the variables."""
        assert edge.sync is not None, "asked of synchronising edges only"
        return int(self._compiled(edge.sync.slot, slot_evaluator)(now.locations, now.values))

    def _receives(self, now: Configuration, edge: Edge, channel: int) -> bool:
        """Whether an edge receives from a channel."""
        receives = edge.sync is not None and not edge.sync.sends
        return receives and self.channel_index(now, edge) == channel

    def compares(self, now: Configuration, compare: ex.ClockCompare) -> bool:
        """Whether a comparison of a clock holds."""
        holds = _COMPARES[compare.op]
        return holds(now.clocks[compare.clock], self.value(now, compare.bound))

    def replay(self, run: Run) -> list[Configuration]:
        """Follow a run with its concrete delays.

        Returns:
            The configuration after each wait and after each action, the initial one first.

        Raises:
            InvalidRunError: the run breaks a rule, or its positions are wrong.
        """
        now = initial_configuration(self._network)
        self._check_invariants(now)
        visited = [now]
        for step in run.steps:
            if step.delay not in step.window:
                raise InvalidRunError(f"a wait of {step.delay} lies outside its window")
            now = self.wait(now, step.delay)
            visited.append(now)
            if step.action is not None:
                now = self.act(now, step.action)
                visited.append(now)
            if (now.locations, now.values) != (step.position.locations, step.position.values):
                raise InvalidRunError("the position of the run is wrong")
        return visited

    def _is_possible(self, now: Configuration, action: Action) -> bool:
        """Whether edges can be taken together, ignoring priorities."""
        try:
            self._taken(now, action)
        except _FailedUpdateError:
            return True
        except InvalidRunError:
            return False
        return True

    def _rank(self, now: Configuration, action: Action) -> int:
        edge = action.edges[0][1]
        channel = None if edge.sync is None else self.channel_index(now, edge)
        assert self._network.priorities is not None, "asked only with priorities"
        return self._network.priorities.rank(channel, (automaton for automaton, _ in action.edges))

    def _taken(self, now: Configuration, action: Action) -> Configuration:
        """The configuration after edges are taken together, ignoring priorities."""
        movers = [automaton for automaton, _ in action.edges]
        for automaton, edge in action.edges:
            if edge not in self._network.automata[automaton].edges:
                name = self._network.automata[automaton].name
                raise InvalidRunError(f"{edge.text} is no edge of {name}")
            if not self.is_ready(now, automaton, edge) or not all(
                self.compares(now, compare) for compare in edge.guard.clocks
            ):
                raise InvalidRunError(f"{edge.text} is not enabled")
        if len(set(movers)) != len(movers):
            raise InvalidRunError("an automaton takes two edges at once")
        self._check_synchronisation(now, action)
        committed = {
            i
            for i, automaton in enumerate(self._network.automata)
            if automaton.locations[now.locations[i]].kind is ex.LocationKind.COMMITTED
        }
        if committed and not committed & set(movers):
            raise InvalidRunError("a committed location is not left")
        after = self._update(now, action)
        self._check_invariants(after)
        return after

    def _holds(self, now: Configuration, guard: Guard) -> bool:
        data = guard.data == ex.TRUE or self.value(now, guard.data)
        return bool(data) and all(self.compares(now, compare) for compare in guard.clocks)

    def _check_invariants(self, now: Configuration) -> None:
        for automaton, place in zip(self._network.automata, now.locations, strict=True):
            location = automaton.locations[place]
            if not self._holds(now, location.invariant):
                where = f"{automaton.name}.{location.name}"
                raise InvalidRunError(f"the invariant of {where} is broken")

    def _ready_edges(self, now: Configuration) -> Iterable[tuple[int, Edge]]:
        for index, automaton in enumerate(self._network.automata):
            for edge in automaton.edges:
                if self.is_ready(now, index, edge):
                    yield index, edge

    def _receivers(self, now: Configuration, sender: int, channel: int) -> set[int]:
        """The automata that can receive from a channel."""
        return {
            index
            for index, edge in self._ready_edges(now)
            if index != sender
            and all(self.compares(now, compare) for compare in edge.guard.clocks)
            and self._receives(now, edge, channel)
        }

    def _check_synchronisation(self, now: Configuration, action: Action) -> None:
        (sender, first), *others = action.edges
        if first.sync is None:
            if others:
                raise InvalidRunError("an edge without a channel is taken with others")
            return
        if not first.sync.sends:
            raise InvalidRunError("the first edge does not send")
        channel = self.channel_index(now, first)
        for _, edge in others:
            if not self._receives(now, edge, channel):
                raise InvalidRunError("an edge does not receive from the channel")
        able = self._receivers(now, sender, channel)
        taking = {automaton for automaton, _ in others}
        if self._network.channels[channel].broadcast:
            if taking != able:
                raise InvalidRunError("a broadcast leaves out a receiver, or has one too many")
        elif len(taking) != 1:
            raise InvalidRunError("a channel has one sender and one receiver")

    def _update(self, now: Configuration, action: Action) -> Configuration:
        locations, clocks = list(now.locations), list(now.clocks)
        frame = Frame(now.values, len(self._network.locals))
        for automaton, edge in action.edges:
            locations[automaton] = edge.target
            try:
                self._compiled(edge.updates, runner)(now.locations, frame)
            except ModelError as error:
                raise _FailedUpdateError(str(error)) from error
        for clock, value in frame.clocks.items():
            clocks[clock] = Fraction(value)
        return Configuration(tuple(locations), frame.variables(), tuple(clocks))
