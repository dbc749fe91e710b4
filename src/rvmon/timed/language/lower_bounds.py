"""Lower bounds in invariants, moved to where they can be broken: the edges that lead there.

A clock only grows while a location is occupied, so that a lower bound that holds on entry holds on,
unless another automaton sets the clock.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rvmon.diagnostics import Span
from rvmon.timed.model.expressions import ClockCompare, ClockOp, Constant
from rvmon.timed.model.guards import resets_in
from rvmon.timed.model.network import Automaton, Channel, Edge
from rvmon.timed.model.rules import model_error

_LOWER = (ClockOp.GE, ClockOp.GT)


def without_lower_bounds(
    automata: Sequence[Automaton], channels: Sequence[Channel]
) -> tuple[Automaton, ...]:
    """The automata with invariants that bound clocks from above only, and the same runs.

    Raises:
        ModelError: a bound depends on variables, fails at the start, or cannot be moved.
    """
    return tuple(
        _without(automaton, [a for a in automata if a is not automaton], channels)
        for automaton in automata
    )


def _without(
    automaton: Automaton, others: Sequence[Automaton], channels: Sequence[Channel]
) -> Automaton:
    lower = [
        [bound for bound in place.invariant.clocks if bound.op in _LOWER]
        for place in automaton.locations
    ]
    if not any(lower):
        return automaton
    for place, bounds in zip(automaton.locations, lower, strict=True):
        for bound in bounds:
            if not isinstance(bound.bound, Constant):
                raise _refusal("the lower bound of this invariant is not constant", place.span)
            sets = (r for a in others for e in a.edges for r in resets_in(e.updates))
            if any(bound.clock == reset.clock for reset in sets):
                message = "an invariant bounds a clock from below that another automaton sets"
                raise _refusal(message, place.span)
    start = automaton.locations[automaton.initial]
    if any(not _holds(bound, 0) for bound in lower[automaton.initial]):
        message = "an invariant of the initial location is false at time 0"
        raise model_error("TA014", message, start.span, "weaken it, or start elsewhere")
    edges = [_guarded(edge, lower[edge.target], channels) for edge in automaton.edges]
    locations = []
    for place in automaton.locations:
        upper = tuple(bound for bound in place.invariant.clocks if bound.op not in _LOWER)
        locations.append(replace(place, invariant=replace(place.invariant, clocks=upper)))
    return replace(
        automaton, locations=tuple(locations), edges=tuple(e for e in edges if e is not None)
    )


def _refusal(message: str, span: Span | None) -> Exception:
    return model_error("TA009", message, span, "put it on the guards of the edges that lead here")


def _holds(bound: ClockCompare, value: int) -> bool:
    assert isinstance(bound.bound, Constant), "looked at before"
    return value >= bound.bound.value + (bound.op is ClockOp.GT)


def _guarded(
    edge: Edge, bounds: Sequence[ClockCompare], channels: Sequence[Channel]
) -> Edge | None:
    """The edge, taken only where the bounds hold behind it; `None` if they never do."""
    added: list[ClockCompare] = []
    for bound in bounds:
        resets = [reset for reset in resets_in(edge.updates) if reset.clock == bound.clock]
        if not resets:
            added.append(bound)
            continue
        value = resets[-1].value
        if not isinstance(value, Constant) or resets[-1] not in edge.updates:
            raise _refusal("an invariant bounds a clock from below that is computed", edge.span)
        if not _holds(bound, value.value):
            return None
    if added and edge.sync is not None:
        channel = channels[edge.sync.slot.first]
        if channel.urgent or (channel.broadcast and not edge.sync.sends):
            message = "an invariant bounds a clock from below behind an urgent or broadcast channel"
            raise _refusal(message, edge.span)
    guard = replace(edge.guard, clocks=(*edge.guard.clocks, *added))
    return replace(edge, guard=guard)
