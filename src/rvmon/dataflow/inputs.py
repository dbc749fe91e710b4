"""What is known of the signals and events: held values, occurrences, staleness."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rvmon.dataflow.outages import note_found, note_lost, outages_at_first
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.runtime.past import History
from rvmon.runtime.table import NEVER
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.health import HealthKind
from rvmon.trace.sample import Payload, Scalar, Value

Reported = Value | tuple[Payload | None, ...]
"""What is taken for a name; a `None` among payloads is an unknown occurrence."""


class Slot(History):
    """One signal.

    Attributes:
        value: as seen now; `None` if unknown, also because it is stale.
        births: 0 before the first known value, 1 from then on, 2 from the update after that on.
        first_at: the instant of the first update, which may belong to a position still to come;
            `None` before it.
        stale_after: as declared.
        stale_at: the instant from which on it is stale; `NEVER` if it cannot become so.
    """

    __slots__ = ("births", "first_at", "stale_after", "stale_at", "value")
    STATE = (*History.STATE, "births", "first_at", "stale_at", "value")

    def __init__(self, stale_after: int | None) -> None:
        super().__init__()
        self.value: Scalar = None
        self.births = 0
        self.first_at: int | None = None
        self.stale_after = stale_after
        self.stale_at = NEVER

    def copy(self) -> Slot:
        """The same, independent from now on."""
        made = Slot(self.stale_after)
        for name in Slot.STATE:
            setattr(made, name, getattr(self, name))
        return made

    def update(self, t: int, value: Any) -> int:
        """Take an update, a scalar; returns whether it is one with another value (Kleene)."""
        if value != value:
            value = None
        if self.births < 2 and (self.births or value is not None):
            self.births += 1
        self.value = value
        if self.stale_after is not None:
            self.stale_at = t + self.stale_after + 1
        return super().update(t, value)


class Inputs:
    """All signals and events of a spec, as of one position.

    Occurrences (of events, updates, changes) belong to one position: they gather until
    `forget_occurrences` is called.

    Attributes:
        slots: by signal.
        occurrences: by event what was said of it for this position, in order.
        updated: the names that were updated for this position.
        changed: by signal, whether an update for this position brought another value.
        absent: names without a source.
        outages: by name what is not known, and since when.
        expired: by signal how often it became stale, and the first instant of that.
    """

    STATE = ("slots", "occurrences", "updated", "expired", "changed", "outages")

    def __init__(self, spec: CheckedSpec, sources: frozenset[str] | None) -> None:
        self.slots = {name: Slot(signal.stale_after) for name, signal in spec.signals.items()}
        names = {*spec.signals, *spec.events}
        self.absent = frozenset() if sources is None else frozenset(names - sources)
        self.occurrences: dict[str, list[Reported]] = {}
        self.updated: set[str] = set()
        self.expired: dict[str, tuple[int, int]] = {}
        self.changed: dict[str, int] = {}
        self.outages = outages_at_first(spec, self.absent)
        self._spec = spec
        self._perishable = [
            (name, slot) for name, slot in self.slots.items() if slot.stale_after is not None
        ]

    def hear(self, t: int, values: Mapping[str, Reported]) -> None:
        """Note which signals had their first update at `t`."""
        for name in values:
            slot = self.slots.get(name)
            if slot is not None and slot.first_at is None:
                slot.first_at = t

    def apply(self, t: int, values: Mapping[str, Reported]) -> None:
        """Take the updates of one sample; `values` are valid and their names have a source."""
        for name, value in values.items():
            self.updated.add(name)
            slot = self.slots.get(name)
            if slot is None:
                self.occurrences.setdefault(name, []).append(value)
            else:
                changed = slot.update(t, value)
                if slot.value is None:
                    why = HealthKind.NONE if value is None else HealthKind.NAN
                    note_lost(self.outages, self._spec, name, why, t)
                elif name in self.outages:
                    note_found(self.outages, name, t)
                self.changed[name] = max(changed, self.changed.get(name, FALSE))

    def forget_occurrences(self) -> None:
        """Leave the position to which the gathered occurrences belong."""
        self.occurrences.clear()
        self.updated.clear()
        self.changed.clear()

    def copy(self) -> Inputs:
        """The same as of this position, independent from now on."""
        made = Inputs.__new__(Inputs)
        made.slots = {name: slot.copy() for name, slot in self.slots.items()}
        made.absent = self.absent
        made.outages = dict(self.outages)
        made._spec = self._spec
        made.occurrences = {name: list(values) for name, values in self.occurrences.items()}
        made.updated = set(self.updated)
        made.expired = dict(self.expired)
        made.changed = dict(self.changed)
        made._perishable = [(name, made.slots[name]) for name, _ in self._perishable]
        return made

    @property
    def next_expiry(self) -> int:
        """The next instant at which a signal becomes stale."""
        soonest = NEVER
        for _, slot in self._perishable:
            if slot.stale_at < soonest:
                soonest = slot.stale_at
        return soonest

    def expire(self, t: int) -> list[str]:
        """Make stale what is so at `t`; returns the names."""
        expired = [name for name, slot in self._perishable if slot.stale_at <= t]
        for name in expired:
            since = self.slots[name].stale_at
            count, first = self.expired.get(name, (0, since))
            self.expired[name] = (count + 1, first)
            note_lost(self.outages, self._spec, name, HealthKind.STALE, since)
            self.slots[name].value = None
            self.slots[name].stale_at = NEVER
        return expired

    def occurs(self, event: str) -> int:
        """Whether an event occurs at this position."""
        if event in self.absent:
            return UNKNOWN
        return max(
            (occurrence_truth(value) for value in self.occurrences.get(event, ())), default=FALSE
        )


def occurrence_truth(value: Reported) -> int:
    """What a sample says of the occurrence of an event."""
    truths = [UNKNOWN if payload is None else TRUE for payload in payloads_of(value)]
    return max(truths, default=FALSE)


def payloads_of(value: Reported) -> tuple[Payload | None, ...]:
    """The payloads of a report of an event: one per occurrence, `None` if it is unknown."""
    if isinstance(value, tuple):
        return value
    if isinstance(value, Mapping):
        return (value,)
    return (None,) if value is None else ({},) if value is True else ()
