"""What nodes remember, taken over by others that go on from there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rvmon.runtime.nodes import Nodes
from rvmon.runtime.values import NEVER

if TYPE_CHECKING:
    from collections.abc import Iterable

_FLAT = (
    *("since", "until", "s", "first", "o", "births", "w", "b", "u", "c"),
    *("wakes", "queued", "stale_at", "timers", "expired"),
)
_SINGLE = ("origin", "before", "gathered", "wake", "position", "dirty", "fading", "last")


def take_all(made: Nodes, other: Nodes) -> None:
    """Have nodes be what others of the same class are, and independent of them from now on."""
    made.v[:] = other.v  # which others read
    for name in _FLAT:
        setattr(made, name, getattr(other, name).copy())
    for name in _SINGLE:
        setattr(made, name, getattr(other, name))
    made.p = [one.copy() for one in other.p]
    made.h = [_copied(one) for one in other.h]
    made.marked = {place: one.copy() for place, one in other.marked.items()}


def take_inputs(made: Nodes, other: Nodes) -> None:
    """Know of signals and events what others know that keep no less of them."""
    made.position, made.gathered = other.position, other.gathered
    if other.origin is not None:
        made.origin, made.before = other.origin, other.before
    last, theirs_last = list(made.last), other.last
    for signal, name in enumerate(made.SIGNALS):
        theirs = other.SIGNALS.index(name)
        for table in ("s", "first", "births"):
            getattr(made, table)[signal] = getattr(other, table)[theirs]
        last[signal] = theirs_last[theirs]
        made.h[signal] = made.h[signal] and _copied(other.h[theirs])
        if other.stale_at[theirs] < NEVER:
            made.set_stale(signal, other.stale_at[theirs])
        if theirs in other.c:
            made.c[signal] = other.c[theirs]
    made.last = tuple(last)
    for event, name in enumerate(made.EVENTS):
        theirs = other.EVENTS.index(name)
        made.o[event], made.p[event] = other.o[theirs], other.p[theirs].copy()
    made.u = other.u.copy()


def take_nodes(made: Nodes, other: Nodes, places: Iterable[tuple[int, int]]) -> None:
    """Have nodes be what they are among others, and remember what they do there.

    Args:
        made: has them.
        other: has begun.
        places: of each there is in both, in the one and in the other.
    """
    for place, theirs in places:
        for table in ("v", "since", "w", "b"):
            getattr(made, table)[place] = getattr(other, table)[theirs]
        made.until[3 * place : 3 * place + 3] = other.until[3 * theirs : 3 * theirs + 3]
        if theirs in other.marked:
            made.marked[place] = other.marked[theirs].copy()
        if other.wakes[theirs] < NEVER:
            made.set_wake(place, other.wakes[theirs])


def remembered(nodes: Nodes, place: int) -> tuple[Any, ...]:
    """What a node remembers, by value."""
    marked = nodes.marked.get(place)
    kept = () if marked is None else marked.memory
    return nodes.w[place], nodes.b[place], kept


def _copied(history: Any) -> Any:
    return history and history.copy()
