"""The state of a run as plain data, and back into a monitor of the same shape.

What a monitor is made of when it is built (formulas, tables, generated code) is not state. Objects
that are *kept* are there in a fresh monitor as well: their fields are set, in place. Objects that
are *made* during a run are made again. Nothing else is taken: no class is looked up by name but in
these two tables, and nothing is executed.
"""

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Mapping
from dataclasses import fields
from enum import Enum
from typing import Any

from rvmon.dataflow import since as flowing
from rvmon.dataflow.flow import Flow
from rvmon.dataflow.hidden import Hidden
from rvmon.dataflow.inputs import Inputs, Slot
from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import Plan
from rvmon.dataflow.outages import Outage
from rvmon.dataflow.positions import Positions
from rvmon.errors import SnapshotError
from rvmon.monitor.attempt_judge import Open
from rvmon.monitor.doubt import Doubt
from rvmon.monitor.episode import Episode
from rvmon.monitor.fed_judge import FedJudge
from rvmon.monitor.generated import GeneratedLanes, GeneratedMonitor
from rvmon.monitor.health import HealthLog
from rvmon.monitor.intake import Intake
from rvmon.monitor.judge import Judge
from rvmon.monitor.lane import Lane, Starter
from rvmon.monitor.lanes import Lanes
from rvmon.monitor.ledger import Ledger
from rvmon.monitor.monitor import Monitor
from rvmon.monitor.network_judge import NetworkJudge
from rvmon.monitor.retention import Kept
from rvmon.monitor.trigger import Trigger
from rvmon.readers.coalesce import Conflicts
from rvmon.runtime import past as generated
from rvmon.runtime.bulk import Run
from rvmon.runtime.nodes import MISSING
from rvmon.runtime.rule import Rule
from rvmon.runtime.unit import Unit
from rvmon.trace.health import HealthKind
from rvmon.verdict.attempt import Attempt, Blame, Decision
from rvmon.verdict.verdict import Verdict

_BENCH = ("attempts", "due", "restless", "position")
_LANES = ("_history", "all")
_MONITOR = ("_ledger", "_kept", "_lanes", "_intake", "_health", "_last", "_reached")
_UNIT = (
    *("v", "since", "until", "s", "last", "first", "o", "p", "u", "c", "h", "w", "b", "marked"),
    *("origin", "before", "gathered", "wake", "wakes", "queued", "stale_at", "expired", "timers"),
    *("began", "rules", "position", "after", "news", "dirty", "fading", "restless", "repeating"),
    *("awaited", "dues", "due_at", "active", "births"),
    *("asked", "eyed", "failing", "resume_at"),
)

_KEPT: Mapping[type, tuple[str, ...]] = {
    Monitor: _MONITOR,
    GeneratedMonitor: (*_MONITOR, "_floor"),
    Ledger: ("attempts", "_counts", "_doubts", "void"),
    Kept: ("dropped", "_seen", "_seen_to"),
    HealthLog: ("began", "_seen"),
    Intake: ("floor", "conflicts", "late", "crowded", "_held", "_taken"),
    Conflicts: ("_seen",),
    Lanes: _LANES,
    GeneratedLanes: ("outages", "unit", "_counts", *_LANES),
    Unit: _UNIT,
    Rule: (
        *("attempts", "runs", "due", "restless", "slides", "position", "letter", "other"),
        *("before", "running", "current", "failed_at", "clouded", "eyed"),
    ),
    FedJudge: (
        *("_judge", "_episode", "due", "restless", "before", "running", "failed_at", "eyed"),
    ),
    Episode: ("current", "failed_at"),
    Lane: (
        *("flow", "judges", "starters", "episodes", "waiting", "_restless", "_repeating"),
        *("_failed", "blurs"),
        *("_soonest", "_awaited"),
    ),
    Starter: ("trigger", "since"),
    Trigger: ("before", "running"),
    Judge: (*_BENCH, "letters"),
    NetworkJudge: (
        *(*_BENCH, "worse", "better", "now", "_letters", "_held"),
        *("_news", "_next_decision", "_changed", "_span"),
    ),
    Flow: (
        *("inputs", "memory", "values", "since", "origin", "position", "_until", "_last"),
        *("_dirty", "_fading", "_wakes", "_left", "cut", "begun"),
    ),
    Inputs: ("slots", "occurrences", "updated", "expired", "changed", "outages"),
    Slot: (
        *(
            "value",
            "updates",
            "first_at",
            "last",
            "at",
            "before",
            "before_at",
            "stale_at",
            "births",
        ),
    ),
    flowing.Since: ("optimistic", "pessimistic", "wake"),
    flowing.Previous: ("seen", "wake"),
    Hidden: ("_now", "_value", "wake"),
}
"""Per class the fields that a run changes, in an order in which what is pointed at comes first."""

_MIXED = ("w", "b")
"""Fields that hold first a number, then something else."""

_MADE: Mapping[str, type] = {
    one.__name__: one
    for one in (
        *(Attempt, Blame, Doubt, Outage, Open, Network, Positions, Run),
        *(generated.History, generated.Since, flowing._Run),
    )
}

_PLAIN: Mapping[str, type] = {
    "tuple": tuple,
    "list": list,
    "set": set,
    "frozenset": frozenset,
    "deque": deque,
}

_CHOICES: Mapping[str, type[Enum]] = {one.__name__: one for one in (Verdict, Decision, HealthKind)}


def _fields_of(class_: type) -> tuple[str, ...]:
    if class_ in (Attempt, Blame):
        return tuple(one.name for one in fields(class_))
    if class_ is Network:
        return (
            *("plan", "positions", "known", "grown", "ahead", "pending", "swept", "carried"),
            *("_letter", "_tidy", "_visits"),
        )
    if class_ is Positions:
        return ("gap", "slope", "first", "last", "_stamps")
    return tuple(class_.__slots__)  # type: ignore[attr-defined]


def _kept_class(value: object) -> type | None:
    """The class in `_KEPT` that an object is of; generated classes are of their base."""
    for class_ in type(value).__mro__:
        if class_ in _KEPT:
            return class_
    return None


class Freezer:
    """Turns state into what JSON can hold.

    Args:
        plans: the plans of networks by a name that they have in every process.
    """

    def __init__(self, plans: Mapping[str, Plan]) -> None:
        self._plans = {id(plan): name for name, plan in plans.items()}
        self._numbers: dict[int, int] = {}
        self._alive: list[object] = []

    def freeze(self, value: Any) -> Any:
        """The state in a value."""
        if value is None or value is True or value is False:
            return value
        if isinstance(value, Enum):
            return ["choice", type(value).__name__, value.value]
        if type(value) in (int, float, str):
            return value
        if value is MISSING:
            return ["missing"]
        if isinstance(value, Mapping):
            return ["dict", *([self.freeze(k), self.freeze(v)] for k, v in value.items())]
        name = type(value).__name__
        if _PLAIN.get(name) is type(value):
            if isinstance(value, set | frozenset):
                value = sorted(value, key=repr)
            return [name, *(self.freeze(one) for one in value)]
        if isinstance(value, array):
            return ["array", value.typecode, *value.tolist()]
        if isinstance(value, Plan):
            return ["plan", self._plans[id(value)]]
        return self._object(value)

    def _object(self, value: Any) -> Any:
        number = self._numbers.get(id(value))
        if number is not None:
            return ["same", number]
        self._numbers[id(value)] = len(self._numbers)
        self._alive.append(value)
        kept = _kept_class(value)
        if kept is not None:
            return ["kept", *(self.freeze(getattr(value, field)) for field in _KEPT[kept])]
        made = type(value)
        if _MADE.get(made.__name__) is not made:
            raise TypeError(f"a {made.__name__} is no state of a run")
        return [made.__name__, *(self.freeze(getattr(value, one)) for one in _fields_of(made))]


class Thawer:
    """Puts frozen state into a fresh monitor.

    Args:
        plans: as for `Freezer`.
    """

    def __init__(self, plans: Mapping[str, Plan]) -> None:
        self._plans = plans
        self._objects: list[object] = []

    def into(self, current: Any, frozen: Any) -> Any:
        """The value that stands for `current`: itself where it is kept, with its fields set."""
        kept = None if current is None else _kept_class(current)
        if kept is not None and _tag(frozen) == "kept":
            self._objects.append(current)
            names = _KEPT[kept]
            for name, one in zip(names, frozen[1:], strict=True):
                before = getattr(current, name)
                kind = _kind(before)
                after = self.into(before, one)
                # What is a number or a table in a fresh monitor is one in any.
                if name not in _MIXED and _kind(after)[: len(kind)] != kind:
                    raise SnapshotError(f"the snapshot is damaged: `{name}` fits no monitor")
                if after is not before:
                    object.__setattr__(current, name, after)
            return current
        if type(current) is list and current and _kept_class(current[0]) is not None:
            for one, own in zip(current, frozen[1:], strict=True):
                self.into(one, own)
            return current
        if type(current) is dict and any(_kept_class(one) for one in current.values()):
            for key, own in frozen[1:]:
                self.into(current[self.thaw(key)], own)
            return current
        value = self.thaw(frozen)
        if type(current) is type(value):
            # Others may hold this very container.
            if isinstance(current, list):
                current[:] = value
                return current
            if isinstance(current, dict | set):
                current.clear()
                current.update(value)
                return current
        return value

    def thaw(self, frozen: Any) -> Any:
        """A value made anew."""
        if not isinstance(frozen, list):
            return frozen
        tag, *rest = frozen
        if tag == "dict":
            return {self.thaw(key): self.thaw(value) for key, value in rest}
        if tag in _PLAIN:
            return _PLAIN[tag](self.thaw(one) for one in rest)
        if tag == "choice":
            return _CHOICES[rest[0]](rest[1])
        if tag == "array":
            return array(rest[0], rest[1:])
        if tag == "missing":
            return MISSING
        if tag == "same":
            return self._objects[rest[0]]
        if tag == "plan":
            return self._plans[rest[0]]
        if tag not in _MADE:
            raise SnapshotError("this is no snapshot of such a monitor: something is of no kind")
        class_ = _MADE[tag]
        made: Any = object.__new__(class_)
        self._objects.append(made)
        for name, one in zip(_fields_of(class_), rest, strict=True):
            object.__setattr__(made, name, self.thaw(one))
        return made


def _kind(value: Any) -> tuple[Any, ...]:
    """What a field stays to be: a type; of a table of numbers its size too; else empty."""
    kind = type(value)
    if kind in (list, tuple) and value and all(type(one) is int for one in value):
        return kind, len(value)
    return (kind,) if kind in (int, bool, list, tuple, dict, set) else ()


def _tag(frozen: Any) -> Any:
    return frozen[0] if isinstance(frozen, list) and frozen else None
