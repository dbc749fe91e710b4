"""Which signals and events a requirement speaks of, and what it compares them with."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from rvmon.report.tracks import Threshold
from rvmon.spec.checked import (
    Arithmetic,
    Binary,
    BoundAtom,
    Captured,
    Compare,
    Constant,
    EventAtom,
    FieldValue,
    Formula,
    Literal,
    Numeric,
    ProbeAtom,
    Requirement,
    SignalAtom,
    SignalValue,
    Unary,
    UpdateValue,
)
from rvmon.verdict.attempt import Blame


def concerned_names(requirement: Requirement) -> tuple[str, ...]:
    """The names that a requirement reads, those of its trigger first, each once."""
    names = (
        name
        for formula in (requirement.trigger, requirement.consequent)
        for atom in _atoms(formula)
        for name in _names(atom)
    )
    return tuple(dict.fromkeys(names))


def blamed_names(requirement: Requirement, blame: Blame) -> frozenset[str]:
    """The names that the failed part of a requirement reads; if it cannot be told, all it owed."""
    owed = list(_atoms(requirement.consequent))
    failed = [
        atom
        for atom in owed
        if atom.span is not None and blame.start <= atom.span.start < blame.end
    ]
    return frozenset(name for atom in failed or owed for name in _names(atom))


def thresholds(requirement: Requirement, name: str) -> tuple[Threshold, ...]:
    """The constants that a requirement compares a signal with, each once."""
    found = [
        threshold
        for formula in (requirement.trigger, requirement.consequent)
        for atom in _atoms(formula)
        if isinstance(atom, Compare)
        for threshold in _thresholds(atom, name)
    ]
    return tuple(dict.fromkeys(found))


_Atom = Constant | SignalAtom | EventAtom | Compare | ProbeAtom | BoundAtom

_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


def _atoms(formula: Formula) -> Iterator[_Atom]:
    match formula:
        case Unary(operand=operand):
            yield from _atoms(operand)
        case Binary(left=left, right=right):
            yield from _atoms(left)
            yield from _atoms(right)
        case _:
            yield formula


def _names(atom: _Atom) -> Iterator[str]:
    match atom:
        case SignalAtom(name=name) | EventAtom(name=name) | ProbeAtom(name=name):
            yield name
        case Compare(left=left, right=right):
            yield from _read(left)
            yield from _read(right)
        case Constant() | BoundAtom():
            return
        case _:
            assert_never(atom)


def _read(expression: Numeric) -> Iterator[str]:
    match expression:
        case SignalValue(name=name) | UpdateValue(name=name):
            yield name
        case FieldValue(event=event):
            yield event
        case Arithmetic(args=args):
            for arg in args:
                yield from _read(arg)
        case Literal() | Captured():
            return
        case _:
            assert_never(expression)


def _thresholds(atom: Compare, name: str) -> Iterator[Threshold]:
    op = atom.op.value
    match atom.left, atom.right:
        case SignalValue(name=read), Literal(value=value) if read == name:
            shown = op
        case Literal(value=value), SignalValue(name=read) if read == name:
            shown = _MIRRORED.get(op, op)
        case _:
            return
    if isinstance(value, int | float):
        yield Threshold(shown, float(value))
