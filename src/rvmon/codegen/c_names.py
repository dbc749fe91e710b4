"""Names and numbers of the things in generated C."""

from __future__ import annotations

import re
from enum import Enum
from functools import cached_property

from rvmon.formula.state import Elapsed, State, StateOp
from rvmon.plan.plan import Plan

_TAKEN = (
    # Names of a monitor so called would be those of functions within the generated C,
    "at holds_at print reach since step visit x y "
    # or of the system's,
    "pthread_cond pthread_mutex "
    # its header would hide one of the C library,
    "errno math stdbool stdint stdio stdlib string "
    # and the namespace of its C++ wrapper would be no name.
    "alignas alignof and asm auto bitand bitor bool break case catch char class compl concept "
    "const consteval constexpr constinit continue decltype default delete do double else enum "
    "explicit export extern false float for friend goto if inline int long mutable namespace new "
    "noexcept not nullptr operator or posix private protected public register requires return "
    "short signed sizeof static std struct switch template this throw true try typedef typeid "
    "typename union unix linux unsigned using virtual void volatile while xor"
)


class Memory(Enum):
    """What a node remembers: a truth value, an instant, stretches of instants."""

    SEEN = "seen"
    EDGE = "edge"
    PAST = "past"


def memory_of(state: State) -> Memory | None:
    """What a state formula has to remember; `None`: nothing."""
    if state.op in (StateOp.PREVIOUS, StateOp.DOUBT):
        return Memory.SEEN
    if state.op is not StateOp.SINCE:
        return None
    if state.low == 0:
        return Memory.SEEN if state.high is None else Memory.EDGE
    return Memory.EDGE if state.high is None else Memory.PAST


class Names:
    """Gives every name of a plan its number in the arrays of the monitor.

    Args:
        plan: what is generated.
        value: how the value of a signal is written, by its number.
    """

    def __init__(self, plan: Plan, value: str = "m->value[{}]") -> None:
        self.plan = plan
        self._value = value
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
        if made and made[0].isalpha() and made not in _TAKEN.split():
            return made
        return f"spec_{made}".rstrip("_")

    def signal(self, name: str) -> int:
        """The number of a signal."""
        return self._signals[name]

    def value(self, name: str) -> str:
        """The value of a signal, as an expression."""
        return self._value.format(self._signals[name])

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
        """For each node that remembers, the number of its memory; each kind is counted apart."""
        slots: dict[int, int] = {}
        counts = dict.fromkeys(Memory, 0)
        for place, state in enumerate(self.plan.graph.nodes):
            kind = memory_of(state)
            if kind is not None:
                slots[place] = counts[kind]
                counts[kind] += 1
        return slots

    @cached_property
    def timers(self) -> dict[int, int]:
        """For each node that time alone can change, the number of its timer; in order of nodes."""
        timed = [
            place
            for place, state in enumerate(self.plan.graph.nodes)
            if isinstance(state.leaf, Elapsed)
            or state.op in (StateOp.PREVIOUS, StateOp.DOUBT)
            or memory_of(state) in (Memory.EDGE, Memory.PAST)
        ]
        return {place: number for number, place in enumerate(timed)}

    def memories(self, kind: Memory) -> int:
        """How many memories of a kind there are."""
        return sum(memory_of(state) is kind for state in self.plan.graph.nodes)
