"""Leaves of state formulas: what they read, and their value at a position."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, assert_never

from rvmon.dataflow.inputs import Inputs, Slot, payloads_of
from rvmon.dataflow.numbers import captured_of, events_of, inputs_of, reader
from rvmon.formula.numeric import signals_of
from rvmon.formula.state import (
    FALSE,
    TRUE,
    UNKNOWN,
    Elapsed,
    Lapsed,
    Leaf,
    Lost,
    Unborn,
)
from rvmon.spec.checked.formula import (
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Literal,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
)
from rvmon.trace.sample import Scalar

Evaluate = Callable[[int], int]
"""From the instant of the position to the leaf's truth there."""


@dataclass(frozen=True, slots=True)
class Reads:
    """What a leaf depends on.

    Attributes:
        names: signals and events whose updates can change it.
        momentary: whether it speaks of one position only and has to be read again at the next.
    """

    names: frozenset[str] = frozenset()
    momentary: bool = False


def reads(leaf: Leaf) -> Reads:
    """What a leaf depends on."""
    match leaf:
        case Constant() | Elapsed() | Lost() | Lapsed():
            return Reads()
        case Unborn(signals=signals):
            return Reads(frozenset(name for name, _ in signals))
        case BoundAtom():
            return Reads(momentary=True)
        case SignalAtom(name=name):
            return Reads(frozenset({name}))
        case EventAtom(name=name):
            return Reads(frozenset({name}), True)
        case ProbeAtom(probe=probe, name=name):
            return Reads(frozenset({name}), probe is not Probe.KNOWN)
        case Compare(left=left, right=right):
            return Reads(inputs_of(left, right), bool(events_of(left, right)))
        case _:
            assert_never(leaf)


def captured_names(leaf: Leaf) -> frozenset[str]:
    """The captured values that a leaf compares with."""
    if isinstance(leaf, Compare):
        return captured_of(leaf.left, leaf.right)
    return frozenset()


def evaluator(
    leaf: Leaf, inputs: Inputs, captured: Mapping[str, Scalar], origin: Callable[[], int | None]
) -> Evaluate:
    """A function that gives the truth of a leaf at the current position.

    Args:
        leaf: any.
        inputs: read at each call.
        captured: values of `let` and `for each`.
        origin: gives the instant of the first position.
    """
    match leaf:
        case Constant(value=value):
            truth = TRUE if value else FALSE
            return lambda _: truth
        case Lost():
            return lambda _: UNKNOWN
        case Lapsed():  # a flow knows when
            return lambda _: FALSE
        case Unborn(signals=signals):
            return lambda _: TRUE if is_unborn(inputs, signals) else FALSE
        case Elapsed(duration=duration):
            return lambda t: TRUE if t - (origin() or 0) >= duration else FALSE
        case BoundAtom():
            return lambda t: TRUE if t == origin() else FALSE
        case SignalAtom(name=name):
            slot = inputs.slots[name]
            return lambda _: UNKNOWN if slot.value is None else TRUE if slot.value else FALSE
        case EventAtom(name=name):
            return lambda _: inputs.occurs(name)
        case ProbeAtom(probe=probe, name=name):
            return _probe(probe, name, inputs)
        case Compare():
            return _compare(leaf, inputs, captured)
        case _:
            assert_never(leaf)


def is_unborn(inputs: Inputs, signals: Iterable[tuple[str, bool]]) -> bool:
    """Whether some signal has not had what is read of it; see `rvmon.formula.state.Unborn`."""
    return any(inputs.slots[name].births <= moved for name, moved in signals)


def before_birth(
    atom: SignalAtom | Compare, read: Evaluate, inputs: Inputs, unborn: int
) -> Evaluate:
    """A reading of an atom over signals that is `unborn` where they are."""
    signals = tuple(signals_of(atom).items())
    if not signals:
        return read
    events = events_of(atom.left, atom.right) if isinstance(atom, Compare) else ()

    def reading(t: int) -> int:
        value = read(t)
        if value != UNKNOWN or not is_unborn(inputs, signals):
            return value
        # An occurrence that is unknown leaves it unknown, born or not.
        return UNKNOWN if any(_is_uncertain(inputs, event) for event in events) else unborn

    return reading


def _is_uncertain(inputs: Inputs, event: str) -> bool:
    reports = inputs.occurrences.get(event, ())
    return event in inputs.absent or any(
        payload is None for value in reports for payload in payloads_of(value)
    )


def _probe(probe: Probe, name: str, inputs: Inputs) -> Evaluate:
    match probe:
        case Probe.KNOWN:
            slot = inputs.slots.get(name)
            if slot is None:
                return lambda _: FALSE if inputs.occurs(name) == UNKNOWN else TRUE
            return lambda _: FALSE if slot.value is None else TRUE
        case _ if name in inputs.absent:
            return lambda _: UNKNOWN
        case Probe.UPDATED:
            return lambda _: TRUE if name in inputs.updated else FALSE
        case Probe.CHANGED:
            return lambda _: inputs.changed.get(name, FALSE)
        case _:
            assert_never(probe)


def _compare(leaf: Compare, inputs: Inputs, captured: Mapping[str, Scalar]) -> Evaluate:
    operation = leaf.op.holds
    left = reader(leaf.left, inputs, captured)
    right = reader(leaf.right, inputs, captured)
    events = events_of(leaf.left, leaf.right)

    def truth(payloads: Mapping[str, Mapping[str, Scalar]]) -> int:
        first, second = left(payloads), right(payloads)
        if first is None or second is None:
            return UNKNOWN
        return TRUE if operation(first, second) else FALSE

    def of_occurrences(_: int) -> int:
        found = FALSE
        choices = [
            [None]
            if event in inputs.absent
            else [p for value in inputs.occurrences.get(event, ()) for p in payloads_of(value)]
            for event in events
        ]
        for chosen in product(*choices):
            payloads = {e: p for e, p in zip(events, chosen, strict=True) if p is not None}
            found = max(found, truth(payloads) if len(payloads) == len(events) else UNKNOWN)
        return found

    if events:
        return of_occurrences
    match leaf:
        case Compare(left=SignalValue(name=name), right=Literal(value=bound)):
            return _against_constant(inputs.slots[name], operation, bound)
        case _:
            return lambda _: truth({})


def _against_constant(slot: Slot, operation: Callable[[Any, Any], bool], bound: Scalar) -> Evaluate:
    """The comparison of a signal with a literal, which is what most comparisons are."""

    def against_constant(_: int) -> int:
        value = slot.value
        return UNKNOWN if value is None else TRUE if operation(value, bound) else FALSE

    return against_constant
