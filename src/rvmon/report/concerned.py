"""Which signals and events a requirement speaks of, and what it compares them with."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.report.tracks import Threshold
from rvmon.spec.checked.formula import Binary, Compare, Literal, SignalValue, Unary
from rvmon.spec.checked.reads import names_read
from rvmon.spec.checked.specification import Requirement
from rvmon.spec.checked.tense import subformulas
from rvmon.verdict.attempt import Blame


def concerned_names(requirement: Requirement) -> tuple[str, ...]:
    """The names that a requirement reads, those of its trigger first, each once."""
    names = (
        name
        for formula in (requirement.trigger, requirement.consequent)
        for name in names_read(formula)
    )
    return tuple(dict.fromkeys(names))


def blamed_names(requirement: Requirement, blame: Blame) -> frozenset[str]:
    """The names that the failed part of a requirement reads; if that is unknown, all it owed."""
    parts = subformulas(requirement.consequent)
    owed = [part for part in parts if not isinstance(part, Unary | Binary)]
    failed = [
        atom
        for atom in owed
        if atom.span is not None and blame.start <= atom.span.start < blame.end
    ]
    return frozenset(name for atom in failed or owed for name in names_read(atom))


def thresholds(requirement: Requirement, name: str) -> tuple[Threshold, ...]:
    """The constants that a requirement compares a signal with, each once."""
    found = [
        threshold
        for formula in (requirement.trigger, requirement.consequent)
        for atom in subformulas(formula)
        if isinstance(atom, Compare)
        for threshold in _thresholds(atom, name)
    ]
    return tuple(dict.fromkeys(found))


def _thresholds(atom: Compare, name: str) -> Iterator[Threshold]:
    match atom.left, atom.right:
        case SignalValue(name=read), Literal(value=value) if read == name:
            shown = atom.op.value
        case Literal(value=value), SignalValue(name=read) if read == name:
            shown = atom.op.mirrored.value
        case _:
            return
    if isinstance(value, int | float):
        yield Threshold(shown, float(value))
