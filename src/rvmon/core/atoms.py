"""What is read off the input at a position, each once: the atoms of a part of a plan."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum, auto

from rvmon.core.programs import Names, Programs, exact
from rvmon.errors import RvmonError
from rvmon.logic.plan import Plan
from rvmon.logic.state_formula import Leaf, events_of, inputs_of, operands
from rvmon.logic.state_graph import captured_names
from rvmon.spec.checked.formula import (
    Bound,
    BoundAtom,
    Compare,
    CompareOp,
    EventAtom,
    Literal,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    UpdateValue,
)
from rvmon.trace.schema import Kind

MOST_EVENTS = 8
"""Of so many events one comparison may read fields."""

_COMPARISONS = {op: number for number, op in enumerate(CompareOp)}


class AtomOp(IntEnum):
    """Kinds of atoms."""

    SIGNAL = 0
    REAL = auto()
    COMPARE = auto()
    PAYLOAD = auto()
    EVENT = auto()
    KNOWN_SIGNAL = auto()
    KNOWN_EVENT = auto()
    UPDATED_SIGNAL = auto()
    UPDATED_EVENT = auto()
    CHANGED = auto()
    START = auto()


@dataclass(frozen=True, slots=True)
class Atom:
    """What is read off the input; names by their numbers in the part.

    Attributes:
        op: what kind of atom it is.
        constant: that a real signal is compared with.
        compare: the number of the comparison.
        input: the signal or event; −1 if there is none, or several.
        left: the place of a program.
        right: the same.
        events: those of which it reads fields.
        values: the signals of which it reads values.
        updates: the signals an update of which changes it, though the value stays.
        occurrences: the events that it reads.
        captured: whether it reads captured values.
    """

    op: AtomOp
    constant: float = 0.0
    compare: int = 0
    input: int = -1
    left: int = -1
    right: int = -1
    events: tuple[int, ...] = ()
    values: tuple[int, ...] = ()
    updates: tuple[int, ...] = ()
    occurrences: tuple[int, ...] = ()
    captured: bool = False

    @property
    def lone_signals(self) -> tuple[int, ...]:
        """The signals that, if they have a source, make it speak of one position."""
        return self.updates if self.op in (AtomOp.UPDATED_SIGNAL, AtomOp.CHANGED) else ()

    @property
    def momentary(self) -> int:
        """How many names with a source make it speak of one position only."""
        return len(self.lone_signals) + len(self.occurrences) + (self.op is AtomOp.START)


class Atoms:
    """The atoms of a part.

    Attributes:
        all: of them, in their order.
    """

    def __init__(self, plan: Plan, names: Names, programs: Programs) -> None:
        self._plan = plan
        self._names = names
        self._programs = programs
        self._numbers: dict[Atom, int] = {}

    @property
    def all(self) -> Sequence[Atom]:
        """All that were asked for, by number."""
        return tuple(self._numbers)

    def number(self, leaf: Leaf) -> int:
        """The number of the atom that a leaf shows."""
        return self._numbers.setdefault(self._atom(leaf), len(self._numbers))

    def itself(self, number: Numeric) -> int:
        """The number of the atom that is unknown where a number is; its programs are of that."""
        same = self._comparison(Compare(CompareOp.EQ, number, number))
        return self._numbers.setdefault(same, len(self._numbers))

    def _atom(self, leaf: Leaf) -> Atom:
        names = self._names
        match leaf:
            case SignalAtom(name=name):
                number = names.signals[name]
                return Atom(AtomOp.SIGNAL, input=number, values=(number,))
            case EventAtom(name=name):
                number = names.events[name]
                return Atom(AtomOp.EVENT, input=number, occurrences=(number,))
            case ProbeAtom(probe=Probe.UPDATED, name=name) if name in names.events:
                number = names.events[name]
                return Atom(AtomOp.UPDATED_EVENT, input=number, occurrences=(number,))
            case ProbeAtom(probe=Probe.KNOWN, name=name):
                number = names.signals[name]
                return Atom(AtomOp.KNOWN_SIGNAL, input=number, values=(number,))
            case ProbeAtom(probe=probe, name=name):
                number = names.signals[name]
                op = AtomOp.CHANGED if probe is Probe.CHANGED else AtomOp.UPDATED_SIGNAL
                return Atom(op, input=number, updates=(number,))
            case BoundAtom(bound=Bound.START):
                return Atom(AtomOp.START)
            case Compare():
                return self._real(leaf) or self._comparison(leaf)
            case _:
                raise ValueError(f"{leaf} is not read off the input")

    def _real(self, leaf: Compare) -> Atom | None:
        """A real signal beside a number."""
        match leaf.left, leaf.right:
            case SignalValue(name=name), Literal(value=int() | float() as value):
                op = leaf.op
            case Literal(value=int() | float() as value), SignalValue(name=name):
                op = leaf.op.mirrored
            case _:
                return None
        constant = exact(value)
        if constant is None or self._plan.spec.signals[name].type.kind is not Kind.REAL:
            return None
        number = self._names.signals[name]
        compare = _COMPARISONS[op]
        return Atom(AtomOp.REAL, constant, compare, input=number, values=(number,))

    def _comparison(self, leaf: Compare) -> Atom:
        sides = leaf.left, leaf.right
        names = self._names
        events = tuple(names.events[event] for event in events_of(*sides))
        if len(events) > MOST_EVENTS:
            raise RvmonError(f"a comparison reads fields of more than {MOST_EVENTS} events")
        updated = [
            part.name for side in sides for part in operands(side) if isinstance(part, UpdateValue)
        ]
        left, right = map(self._programs.place, sides)
        return Atom(
            AtomOp.PAYLOAD if events else AtomOp.COMPARE,
            compare=_COMPARISONS[leaf.op],
            left=left,
            right=right,
            events=events,
            values=_chosen(names.signals, inputs_of(*sides)),
            updates=_chosen(names.signals, updated),
            occurrences=tuple(sorted(events)),
            captured=bool(captured_names(leaf)),
        )


def _chosen(numbers: Mapping[str, int], names: Iterable[str]) -> tuple[int, ...]:
    """The numbers of those names that have one, in order."""
    return tuple(sorted({numbers[name] for name in names if name in numbers}))
