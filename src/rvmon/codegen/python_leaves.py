"""Leaves of state formulas as Python expressions over the arrays of a generated monitor."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import assert_never

from rvmon.codegen.unit_plan import Plan
from rvmon.dataflow.numbers import events_of
from rvmon.formula.numeric import signals_of
from rvmon.formula.state import UNKNOWN, Elapsed, Lapsed, Leaf, Lost, Unborn
from rvmon.spec.checked.formula import (
    Arithmetic,
    BoundAtom,
    Captured,
    Compare,
    Constant,
    EventAtom,
    FieldValue,
    Literal,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    UpdateValue,
)


def leaf_expression(plan: Plan, place: int, leaf: Leaf) -> str:
    """The value of a leaf at `t`, in a method of the monitor with `s` at hand."""
    unborn = plan.graph.nodes[place].unborn
    if isinstance(leaf, SignalAtom | Compare) and unborn != UNKNOWN:
        return _before_birth(plan, leaf, str(unborn))
    match leaf:
        case Lapsed():
            return f"self.lapsed_({place}, t)"
        case Lost():
            return "1"
        case Unborn(signals=signals):
            return f"2 if {_unborn(plan, signals)} else 0"
        case Constant(value=value):
            return "2" if value else "0"
        case Elapsed(duration=duration):
            return f"self.elapsed_({place}, t, {duration})"
        case BoundAtom():
            return "2 if t == self.origin else 0"
        case SignalAtom() | Compare():
            return _atom(plan, leaf)
        case EventAtom(name=name):
            return f"self.o[{plan.events.index(name)}]"
        case ProbeAtom(probe=probe, name=name):
            return _probe(plan, probe, name)
        case _:
            assert_never(leaf)


def _unborn(plan: Plan, signals: Iterable[tuple[str, bool]]) -> str:
    """Whether some signal has not had what is read of it."""
    places = ((plan.signals.index(name), moved) for name, moved in signals)
    return " or ".join(f"self.births[{place}] < {2 if moved else 1}" for place, moved in places)


def _before_birth(plan: Plan, atom: SignalAtom | Compare, unborn: str) -> str:
    """The value of an atom over signals, which is something else before their birth."""
    signals = signals_of(atom).items()
    if not signals:
        return _atom(plan, atom)
    early = f"{unborn} if {_unborn(plan, signals)} else 1"
    if isinstance(atom, Compare):
        events = [plan.events.index(event) for event in events_of(atom.left, atom.right)]
        if events:
            early = f"1 if self.uncertain_({events!r}) else {early}"
            return f"({early}) if (got := {_atom(plan, atom)}) == 1 else got"
        if not _is_plain(atom):
            return f"({early}) if (got := {_atom(plan, atom)}) == 1 else got"
    return _atom(plan, atom).replace("1 if", f"({early}) if", 1)


def _is_plain(atom: Compare) -> bool:
    return isinstance(atom.left, SignalValue) and isinstance(atom.right, Literal)


def _atom(plan: Plan, atom: SignalAtom | Compare) -> str:
    if isinstance(atom, Compare):
        return comparison(plan, atom)
    held = f"s[{plan.signals.index(atom.name)}]"
    return f"1 if {held} is None else 2 if {held} else 0"


def known_test(leaf: Leaf | None, variable: str) -> str | None:
    """The test of a leaf, given the value of the one signal that it reads; `None`: there is none.

    Args:
        leaf: depends on the present value of one signal and nothing else.
        variable: holds that value, which is known.
    """
    match leaf:
        case SignalAtom():
            return variable
        case Compare(op=op, left=SignalValue(), right=Literal(value=value)):
            return f"{variable} {op.value} {_literal(value)}"
        case _:
            return None


def _probe(plan: Plan, probe: Probe, name: str) -> str:
    match probe:
        case Probe.KNOWN:
            if name in plan.signals:
                return f"0 if s[{plan.signals.index(name)}] is None else 2"
            return f"0 if self.o[{plan.events.index(name)}] == 1 else 2"
        case Probe.UPDATED:
            return f"1 if {name!r} in self.absent else 2 if {name!r} in self.u else 0"
        case Probe.CHANGED:
            return f"1 if {name!r} in self.absent else self.c.get({plan.signals.index(name)}, 0)"
        case _:
            assert_never(probe)


def comparison(plan: Plan, leaf: Compare) -> str:
    """The truth of a comparison."""
    left, right = leaf.left, leaf.right
    if isinstance(left, SignalValue) and isinstance(right, Literal):
        held = f"s[{plan.signals.index(left.name)}]"
        return (
            f"1 if {held} is None else 2 if {held} {leaf.op.value} {_literal(right.value)} else 0"
        )
    both = f"compared({leaf.op.python}, {_number(plan, left)}, {_number(plan, right)})"
    events = events_of(left, right)
    if not events:
        return both
    listed = "".join(f"{plan.events.index(event)}, " for event in events)
    return f"self.over_(({listed}), lambda q: {both})"


def _number(plan: Plan, expression: Numeric) -> str:
    match expression:
        case Literal(value=value):
            return _literal(value)
        case SignalValue(name=name):
            return f"s[{plan.signals.index(name)}]"
        case FieldValue(event=event, field=field):
            return f"number(q[{plan.events.index(event)}].get({field!r}))"
        case UpdateValue(function=function, name=name):
            signal = plan.signals.index(name)
            return f"self.h[{signal}].{function.value}(s[{signal}])"
        case Arithmetic(op=op, args=args):
            listed = ", ".join(_number(plan, arg) for arg in args)
            return f"finite({op.entry.python}, {listed})"
        case Captured(name=name):
            return f"self.captured[{name!r}]"
        case _:
            assert_never(expression)


def _literal(value: float | int | str) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{value} is no number of a specification")
    return repr(value)
