"""Stretches of time over which a signal was not known."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.health import HealthKind


@dataclass(slots=True, eq=False)
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


def outages_at_first(spec: CheckedSpec, absent: Set[str]) -> dict[str, Outage]:
    """What is not known before the first sample.

    Args:
        spec: declares the names.
        absent: those without a source.
    """
    found = {name: Outage(name, HealthKind.MISSING) for name in spec.signals}
    return found | {name: Outage(name, HealthKind.ABSENT) for name in absent}


def note_lost(
    outages: dict[str, Outage], spec: CheckedSpec, name: str, why: HealthKind, t: int
) -> None:
    """Note that a signal is not known from `t` on; one that already was not stays as noted."""
    if name not in outages:
        outages[name] = Outage(name, why, t, None, spec.signals[name].stale_after or 0)


def note_found(outages: dict[str, Outage], name: str, t: int) -> None:
    """Note that a signal has a value from `t` on."""
    outage = outages.pop(name, None)
    if outage is not None:
        outage.until = t
