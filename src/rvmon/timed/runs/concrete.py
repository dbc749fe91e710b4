"""The rules of a network for single valuations of the clocks, with exact rational times.

This is the meaning that zones stand for, written once more and without them, so that every run the
checker gives is checked by other code than found it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from rvmon.errors import ModelError
from rvmon.timed.model.evaluate import Frame, evaluator, runner, slot_evaluator
from rvmon.timed.model.expressions import (
    TRUE,
    ClockCompare,
    ClockOp,
)
from rvmon.timed.model.network import Edge, Guard, Network, Priorities
from rvmon.timed.model.operators import LocationKind
from rvmon.timed.runs.run import Action, Run


@dataclass(frozen=True, slots=True)
class Configuration:
    """Locations, variables and the exact value of each clock."""

    locations: tuple[int, ...]
    values: tuple[int, ...]
    clocks: tuple[Fraction, ...]


class InvalidRunError(AssertionError):
    """A run breaks a rule of the network."""


class _FailedUpdateError(InvalidRunError):
    """What is taken has no value."""


def initial_configuration(network: Network) -> Configuration:
    """Where every run starts."""
    return Configuration(
        tuple(automaton.initial for automaton in network.automata),
        tuple(variable.initial for variable in network.variables),
        (Fraction(0),) * len(network.clocks),
    )


def wait(network: Network, now: Configuration, delay: Fraction) -> Configuration:
    """Let time pass.

    Raises:
        InvalidRunError: time may not pass that long here.
    """
    if delay < 0:
        raise InvalidRunError("time goes backwards")
    later = Configuration(now.locations, now.values, tuple(clock + delay for clock in now.clocks))
    if delay > 0 and stops_time(network, now):
        raise InvalidRunError("time passes in an urgent state")
    _check_invariants(network, later)
    return later


def act(network: Network, now: Configuration, action: Action) -> Configuration:
    """Take the edges of an action together.

    Raises:
        InvalidRunError: they cannot be taken, or not like this.
    """
    after = _behind(network, now, action)
    if network.priorities is not None:
        own = _rank(network.priorities, now, action)
        for other in every_action(network, now):
            if _rank(network.priorities, now, other) > own and _is_possible(network, now, other):
                raise InvalidRunError("a step of higher priority can be taken")
    return after


def _is_possible(network: Network, now: Configuration, action: Action) -> bool:
    """Whether edges can be taken together, priorities apart."""
    try:
        _behind(network, now, action)
    except _FailedUpdateError:
        return True
    except InvalidRunError:
        return False
    return True


def _rank(priorities: Priorities, now: Configuration, action: Action) -> int:
    edge = action.edges[0][1]
    channel = None if edge.sync is None else channel_index(now, edge)
    return priorities.rank(channel, (automaton for automaton, _ in action.edges))


def every_action(network: Network, now: Configuration) -> Iterator[Action]:
    """Every choice of edges that could be an action, whether or not the other rules allow it."""
    edges = list(_ready_edges(network, now))
    for sender, first in edges:
        if first.sync is None:
            yield Action(((sender, first),))
        elif first.sync.sends:
            channel = channel_index(now, first)
            choices: list[list[tuple[int, Edge] | None]] = []
            for index in range(len(network.automata)):
                able: list[tuple[int, Edge] | None] = [
                    (other, edge)
                    for other, edge in edges
                    if other == index != sender
                    and edge.sync is not None
                    and not edge.sync.sends
                    and channel_index(now, edge) == channel
                ]
                choices.append([*able, None])
            for chosen in product(*choices):
                yield Action(((sender, first), *(other for other in chosen if other is not None)))


def _behind(network: Network, now: Configuration, action: Action) -> Configuration:
    """Where edges lead that are taken together, priorities apart."""
    movers = [automaton for automaton, _ in action.edges]
    for automaton, edge in action.edges:
        if edge not in network.automata[automaton].edges:
            raise InvalidRunError(f"{edge.text} is no edge of {network.automata[automaton].name}")
        if not is_ready(now, automaton, edge) or not all(
            compares(now, compare) for compare in edge.guard.clocks
        ):
            raise InvalidRunError(f"{edge.text} is not enabled")
    if len(set(movers)) != len(movers):
        raise InvalidRunError("an automaton takes two edges at once")
    _check_synchronisation(network, now, action)
    committed = {
        i
        for i, automaton in enumerate(network.automata)
        if automaton.locations[now.locations[i]].kind is LocationKind.COMMITTED
    }
    if committed and not committed & set(movers):
        raise InvalidRunError("a committed location is not left")
    after = _update(network, now, action)
    _check_invariants(network, after)
    return after


def stops_time(network: Network, now: Configuration) -> bool:
    """Whether an urgent or committed location or an urgent channel keeps time from passing."""
    kinds = (
        automaton.locations[place].kind
        for automaton, place in zip(network.automata, now.locations, strict=True)
    )
    if any(kind is not LocationKind.NORMAL for kind in kinds):
        return True
    for automaton, edge in _ready_edges(network, now):
        if edge.sync is None or not edge.sync.sends:
            continue
        channel = network.channels[channel_index(now, edge)]
        if channel.urgent and (
            channel.broadcast or _receivers(network, now, automaton, channel_index(now, edge))
        ):
            return True
    return False


def is_ready(now: Configuration, automaton: int, edge: Edge) -> bool:
    """Whether an edge starts here and its guard on the variables holds."""
    here = now.locations[automaton] == edge.source
    return here and bool(evaluator(edge.guard.data)(now.locations, now.values))


def channel_index(now: Configuration, edge: Edge) -> int:
    """The channel that an edge uses, given the variables."""
    assert edge.sync is not None, "asked of synchronising edges only"
    return slot_evaluator(edge.sync.slot)(now.locations, now.values)


def compares(now: Configuration, compare: ClockCompare) -> bool:
    """Whether a clock is as a comparison says."""
    clock = now.clocks[compare.clock]
    bound = evaluator(compare.bound)(now.locations, now.values)
    match compare.op:
        case ClockOp.LT:
            return clock < bound
        case ClockOp.LE:
            return clock <= bound
        case ClockOp.GE:
            return clock >= bound
        case ClockOp.GT:
            return clock > bound


def replay(network: Network, run: Run) -> list[Configuration]:
    """Go along a run with its concrete delays.

    Returns:
        The configuration after each wait and after each action, the initial one first.

    Raises:
        InvalidRunError: the run breaks a rule, or is not where it says it is.
    """
    now = initial_configuration(network)
    _check_invariants(network, now)
    visited = [now]
    for step in run.steps:
        if step.delay not in step.window:
            raise InvalidRunError(f"a wait of {step.delay} lies outside its window")
        now = wait(network, now, step.delay)
        visited.append(now)
        if step.action is not None:
            now = act(network, now, step.action)
            visited.append(now)
        if (now.locations, now.values) != (step.position.locations, step.position.values):
            raise InvalidRunError("the run is elsewhere")
    return visited


def _holds(now: Configuration, guard: Guard) -> bool:
    data = guard.data == TRUE or evaluator(guard.data)(now.locations, now.values)
    return bool(data) and all(compares(now, compare) for compare in guard.clocks)


def _check_invariants(network: Network, now: Configuration) -> None:
    for automaton, place in zip(network.automata, now.locations, strict=True):
        location = automaton.locations[place]
        if not _holds(now, location.invariant):
            raise InvalidRunError(f"the invariant of {automaton.name}.{location.name} is broken")


def _ready_edges(network: Network, now: Configuration) -> Iterable[tuple[int, Edge]]:
    for index, automaton in enumerate(network.automata):
        for edge in automaton.edges:
            if is_ready(now, index, edge):
                yield index, edge


def _receivers(network: Network, now: Configuration, sender: int, channel: int) -> set[int]:
    """The automata that can receive from a channel."""
    return {
        index
        for index, edge in _ready_edges(network, now)
        if index != sender
        and all(compares(now, compare) for compare in edge.guard.clocks)
        and edge.sync is not None
        and not edge.sync.sends
        and channel_index(now, edge) == channel
    }


def _check_synchronisation(network: Network, now: Configuration, action: Action) -> None:
    (sender, first), *others = action.edges
    if first.sync is None:
        if others:
            raise InvalidRunError("an edge without channel has company")
        return
    if not first.sync.sends:
        raise InvalidRunError("the first edge does not send")
    channel = channel_index(now, first)
    for _, edge in others:
        if edge.sync is None or edge.sync.sends or channel_index(now, edge) != channel:
            raise InvalidRunError("an edge does not receive from the channel")
    able = _receivers(network, now, sender, channel)
    taking = {automaton for automaton, _ in others}
    if network.channels[channel].broadcast:
        if taking != able:
            raise InvalidRunError("a broadcast leaves out a receiver, or has one too many")
    elif len(taking) != 1:
        raise InvalidRunError("a channel has one sender and one receiver")


def _update(network: Network, now: Configuration, action: Action) -> Configuration:
    locations, clocks = list(now.locations), list(now.clocks)
    frame = Frame(now.values, len(network.locals))
    for automaton, edge in action.edges:
        locations[automaton] = edge.target
        try:
            runner(edge.updates)(now.locations, frame)
        except ModelError as error:
            raise _FailedUpdateError(str(error)) from error
    for clock, value in frame.clocks.items():
        clocks[clock] = Fraction(value)
    return Configuration(tuple(locations), frame.variables(), tuple(clocks))
