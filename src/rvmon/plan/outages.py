"""What is not known of signals, and over which stretches of time."""

from __future__ import annotations

from collections.abc import Set
from copy import copy
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


class Outages:
    """What is not known of the signals and events of a run.

    Args:
        spec: declares the names.
        sources: the names that can arrive; `None`: all.

    Attributes:
        absent: the names without a source.
        now: by name, what is not known.
    """

    def __init__(self, spec: CheckedSpec, sources: Set[str] | None) -> None:
        names = {*spec.signals, *spec.events}
        self.absent: frozenset[str] = frozenset(() if sources is None else names - sources)
        self.now = {name: Outage(name, HealthKind.MISSING) for name in spec.signals}
        self.now |= {name: Outage(name, HealthKind.ABSENT) for name in self.absent}
        self._spec = spec

    def copy(self) -> Outages:
        """The same, independent from now on."""
        made = copy(self)
        made.now = dict(self.now)
        return made

    def lost(self, name: str, t: int, why: str) -> None:
        """Note that a signal is not known from `t` on; one that already was not stays as noted.

        Args:
            name: of the signal.
            t: ticks.
            why: the value of a `HealthKind`.
        """
        if name not in self.now:
            bound = self._spec.signals[name].stale_after or 0
            self.now[name] = Outage(name, HealthKind(why), t, None, bound)

    def found(self, name: str, t: int) -> None:
        """Note that a signal has a value from `t` on."""
        outage = self.now.pop(name, None)
        if outage is not None:
            outage.until = t
