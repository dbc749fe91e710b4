"""Which input left an attempt open, and why that was not known."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.spec.print.printer import format_duration
from rvmon.trace.health import HealthKind
from rvmon.trace.time import format_ticks


@dataclass(frozen=True, slots=True, eq=False)
class Outage:
    """A stretch over which a signal or event was not known; it ends when a value comes.

    Attributes:
        name: of the signal or event.
        why: what it began with; `MISSING` if there was no value yet, `ABSENT` if there is no
            source.
        since: its first instant, ticks; of no meaning for `MISSING` and `ABSENT`.
        until: the instant from which on it was known again, ticks; `None` if it still is not.
        bound: if it is stale, the time without an update that made it so, ticks.
    """

    name: str
    why: HealthKind
    since: int = 0
    until: int | None = None
    bound: int = 0


@dataclass(frozen=True, slots=True)
class Doubt:
    """Why the two runs of an attempt parted: what was not known.

    Attributes:
        position: where.
        outages: of the signals and events in question; that they ended may become known later.
        texts: of propositions that were unknown though all they read was known.
    """

    position: int
    outages: tuple[Outage, ...]
    texts: tuple[str, ...]

    def __str__(self) -> str:
        """One or several clauses.

        >>> second = 10**9
        >>> stale = Outage("far", HealthKind.STALE, second + 1, 4 * second, second // 2)
        >>> print(Doubt(2 * second, (stale,), ()))
        `far` was not known from 1 s to 4 s: no update for 500 ms (stale)
        """
        causes = [outage_in_words(outage) for outage in self.outages]
        at = format_ticks(self.position)
        causes += [f"`{text}` was not known at {at}" for text in self.texts]
        return "; ".join(causes) or f"what was not known before still mattered at {at}"


def outage_in_words(outage: Outage) -> str:
    """From when to when a signal was not known, and why."""
    name = f"`{outage.name}`"
    if outage.why is HealthKind.ABSENT:
        return f"{name} has no source"
    if outage.why is HealthKind.MISSING:
        if outage.until is None:
            return f"{name} never had a value"
        return f"{name} had no value before {format_ticks(outage.until)}"
    # What is stale is so a tick after the time that it is given.
    since = format_ticks(outage.since - (outage.why is HealthKind.STALE))
    end = "on" if outage.until is None else f"to {format_ticks(outage.until)}"
    match outage.why:
        case HealthKind.STALE:
            why = f"no update for {format_duration(outage.bound)} (stale)"
        case HealthKind.NAN:
            why = f"NaN at {since}"
        case HealthKind.NONE:
            why = f"None at {since}"
        case _:
            raise AssertionError(f"{outage.why} makes no signal unknown")
    return f"{name} was not known from {since} {end}: {why}"
