"""The state of a run as plain data, and back into a monitor of the same shape.

What a monitor is made of when it is built (formulas, tables, generated code) is not state. A class
names the fields that a run changes in `STATE`, what is pointed at first, and in `VARIED` those of
them that hold first a number, then something else. What is there in a fresh monitor as well has its
fields set, in place; what is made during a run is made again, of the few classes that are listed
here. Nothing else is taken: no class is looked up by name but here, and nothing is executed.
"""

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Mapping
from dataclasses import fields
from enum import Enum
from typing import Any

from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.dataflow.positions import Positions
from rvmon.errors import SnapshotError
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.reasons.doubt import Doubt
from rvmon.plan.outages import Outage
from rvmon.runtime.bulk import Run
from rvmon.runtime.nodes import MISSING
from rvmon.runtime.past import History, Since
from rvmon.trace.health import HealthKind
from rvmon.verdict.attempt import Attempt, Blame, Decision
from rvmon.verdict.verdict import Verdict

_MADE: Mapping[str, type] = {
    one.__name__: one
    for one in (Attempt, Blame, Doubt, Outage, Open, Network, Positions, Run, History, Since)
}
"""What is made during a run."""

_PLAIN: Mapping[str, type] = {
    "tuple": tuple,
    "list": list,
    "set": set,
    "frozenset": frozenset,
    "deque": deque,
}

_CHOICES: Mapping[str, type[Enum]] = {one.__name__: one for one in (Verdict, Decision, HealthKind)}


def _state_of(class_: type) -> tuple[str, ...]:
    """The fields that a run changes; of data that is made in a run, all."""
    found: tuple[str, ...] | None = getattr(class_, "STATE", None)
    return tuple(one.name for one in fields(class_)) if found is None else found


def _name_of(value: object) -> str:
    """The class that says what the state of an object is; generated classes say nothing."""
    made = (one for one in type(value).__mro__ if "STATE" in vars(one))
    return next(made, type(value)).__name__


def _is_kept(value: object) -> bool:
    """Whether something of a fresh monitor has state of its own."""
    return hasattr(value, "STATE")


class Freezer:
    """Turns state into what JSON can hold.

    Args:
        plans: the plans of networks by a name that they have in every process.
    """

    def __init__(self, plans: Mapping[str, NetworkPlan]) -> None:
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
        if isinstance(value, NetworkPlan):
            return ["plan", self._plans[id(value)]]
        return self._object(value)

    def _object(self, value: Any) -> Any:
        number = self._numbers.get(id(value))
        if number is not None:
            return ["same", number]
        self._numbers[id(value)] = len(self._numbers)
        self._alive.append(value)
        name = _name_of(value)
        if not _is_kept(value) and _MADE.get(name) is not type(value):
            raise TypeError(f"a {name} is no state of a run")
        return [name, *(self.freeze(getattr(value, one)) for one in _state_of(type(value)))]


class Thawer:
    """Puts frozen state into a fresh monitor.

    Args:
        plans: as for `Freezer`.
    """

    def __init__(self, plans: Mapping[str, NetworkPlan]) -> None:
        self._plans = plans
        self._objects: list[object] = []

    def into(self, current: Any, frozen: Any) -> Any:
        """The value that stands for `current`: itself where it is kept, with its fields set."""
        if _is_kept(current) and _tag(frozen) == _name_of(current):
            self._objects.append(current)
            for name, one in zip(current.STATE, frozen[1:], strict=True):
                before = getattr(current, name)
                kind = () if name in getattr(current, "VARIED", ()) else _kind(before)
                after = self.into(before, one)
                # What is a number or a table in a fresh monitor is one in any.
                if _kind(after)[: len(kind)] != kind:
                    raise SnapshotError(f"the snapshot is damaged: `{name}` fits no monitor")
                if after is not before:
                    setattr(current, name, after)
            return current
        if type(current) is list and current and _is_kept(current[0]):
            for one, own in zip(current, frozen[1:], strict=True):
                self.into(one, own)
            return current
        if type(current) is dict and any(_is_kept(one) for one in current.values()):
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
        for name, one in zip(_state_of(class_), rest, strict=True):
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
