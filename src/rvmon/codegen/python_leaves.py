"""Leaves of state formulas as Python expressions over the arrays of a generated monitor."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import assert_never

from rvmon.formula.numeric import signals_of
from rvmon.formula.state import UNKNOWN, Elapsed, Lapsed, Leaf, Lost, Unborn
from rvmon.plan.numbers import events_of
from rvmon.plan.plan import Plan
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
    """The value of a leaf at `t`, in a method of the monitor."""
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
            return _atom(plan, leaf, plan.graph.nodes[place].unborn)
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


def _atom(plan: Plan, atom: SignalAtom | Compare, unborn: int) -> str:
    """The value of an atom over signals, which is `unborn` before their birth."""
    unknown = _unknown(plan, atom, unborn)
    match atom:
        case SignalAtom(name=name) | Compare(left=SignalValue(name=name), right=Literal()):
            held = f"self.s[{plan.signals.index(name)}]"
            return f"{unknown} if {held} is None else 2 if {known_test(atom, held)} else 0"
        case _:
            found = _comparison(plan, atom)
            return found if unknown == "1" else f"{unknown} if (got := {found}) == 1 else got"


def _unknown(plan: Plan, atom: SignalAtom | Compare, unborn: int) -> str:
    """The value of an atom over signals where it is not known what it reads."""
    signals = signals_of(atom).items()
    if unborn == UNKNOWN or not signals:
        return "1"
    early = f"{unborn} if {_unborn(plan, signals)} else 1"
    if isinstance(atom, Compare):
        events = [plan.events.index(event) for event in events_of(atom.left, atom.right)]
        if events:
            early = f"1 if self.uncertain_({events!r}) else {early}"
    return f"({early})"


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
                return f"0 if self.s[{plan.signals.index(name)}] is None else 2"
            return f"0 if self.o[{plan.events.index(name)}] == 1 else 2"
        case Probe.UPDATED:
            return f"1 if {name!r} in self.absent else 2 if {name!r} in self.u else 0"
        case Probe.CHANGED:
            return f"1 if {name!r} in self.absent else self.c.get({plan.signals.index(name)}, 0)"
        case _:
            assert_never(probe)


def _comparison(plan: Plan, leaf: Compare) -> str:
    """The truth of a comparison of numbers that are worked out."""
    left, right = leaf.left, leaf.right
    sides = f"{number_expression(plan, left)}, {number_expression(plan, right)}"
    both = f"compared({leaf.op.python}, {sides})"
    events = events_of(left, right)
    if not events:
        return both
    listed = "".join(f"{plan.events.index(event)}, " for event in events)
    return f"self.over_(({listed}), lambda q: {both})"


def number_expression(plan: Plan, expression: Numeric) -> str:
    """A number that is worked out, in a method of the monitor; `None` where it is not known."""
    match expression:
        case Literal(value=value):
            return _literal(value)
        case SignalValue(name=name):
            return f"self.s[{plan.signals.index(name)}]"
        case FieldValue(event=event, field=field):
            return f"number(q[{plan.events.index(event)}].get({field!r}))"
        case UpdateValue(function=function, name=name):
            signal = plan.signals.index(name)
            return f"self.h[{signal}].{function.value}(self.s[{signal}])"
        case Arithmetic(op=op, args=args):
            listed = ", ".join(number_expression(plan, arg) for arg in args)
            return f"finite({op.entry.python}, {listed})"
        case Captured(name=name):
            return f"self.captured[{name!r}]"
        case _:
            assert_never(expression)


def _literal(value: float | int | str) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{value} is no number of a specification")
    return repr(value)
