"""Names and numbers of the things in generated C."""

from __future__ import annotations

import re
from functools import cached_property

from rvmon.codegen.plan import Plan
from rvmon.formula.state import StateOp


class Names:
    """Gives every name of a plan its number in the arrays of the monitor.

    Args:
        plan: what is generated.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._signals = {name: number for number, name in enumerate(plan.signals)}
        self._events = {name: number for number, name in enumerate(plan.events)}
        self.fields = {
            (event, field): number
            for number, (event, field) in enumerate(
                (event, field) for event in plan.events for field in plan.spec.events[event].fields
            )
        }
        """By event and field, the place in a sample's `field`."""

    @cached_property
    def prefix(self) -> str:
        """What all identifiers start with."""
        made = re.sub(r"[^A-Za-z0-9]+", "_", self.plan.spec.name).strip("_").lower()
        return made if made and made[0].isalpha() else f"spec_{made}".rstrip("_")

    def signal(self, name: str) -> int:
        """The number of a signal."""
        return self._signals[name]

    def event(self, name: str) -> int:
        """The number of an event."""
        return self._events[name]

    def number(self, name: str) -> int:
        """The number of a signal or event: signals first."""
        if name in self._signals:
            return self._signals[name]
        return len(self._signals) + self._events[name]

    def field(self, event: str, field: str) -> int:
        """The place of a payload's field."""
        return self.fields[event, field]

    @cached_property
    def labels(self) -> dict[str, int]:
        """A number for each label, whatever type it belongs to."""
        found: dict[str, int] = {}
        types = [signal.type for signal in self.plan.spec.signals.values()]
        for event in self.plan.spec.events.values():
            types += event.fields.values()
        for type_ in types:
            for label in type_.labels:
                found.setdefault(label, len(found))
        return found

    def label(self, text: str) -> int:
        """The number of a label; −1 for one that no value can be."""
        return self.labels.get(text, -1)

    @cached_property
    def memory(self) -> dict[int, int]:
        """For each node that remembers, the number of its memory; `since` and `previous` apart."""
        slots: dict[int, int] = {}
        counts = {StateOp.SINCE: 0, StateOp.PREVIOUS: 0}
        for place, state in enumerate(self.plan.graph.nodes):
            if state.op in counts:
                slots[place] = counts[state.op]
                counts[state.op] += 1
        return slots

    def identifier(self, name: str) -> str:
        """A name as part of a C identifier."""
        return re.sub(r"[^A-Za-z0-9]", "_", name).upper()
