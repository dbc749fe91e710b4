"""Which signals and events a formula or a whole specification reads."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.spec.checked.ctl import (
    PathBinary,
    PathUnary,
    StateAtom,
    StateBinary,
    StateFormula,
    StateNot,
)
from rvmon.spec.checked.formula import (
    Arithmetic,
    Compare,
    EventAtom,
    FieldValue,
    Formula,
    Numeric,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    UpdateValue,
)
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.spec.checked.tense import subformulas


def names_read(formula: Formula) -> Iterator[str]:
    """The names of the signals and events that a formula reads, with repetitions."""
    for part in subformulas(formula):
        match part:
            case SignalAtom(name=name) | EventAtom(name=name) | ProbeAtom(name=name):
                yield name
            case Compare(left=left, right=right):
                yield from names_in(left)
                yield from names_in(right)


def names_in(numeric: Numeric) -> Iterator[str]:
    """The names that a number is made of."""
    waiting = [numeric]
    while waiting:
        match waiting.pop():
            case SignalValue(name=name) | UpdateValue(name=name) | FieldValue(event=name):
                yield name
            case Arithmetic(args=args):
                waiting += args


def names_of_requirement(requirement: Requirement) -> Iterator[str]:
    """The names that a requirement reads to be judged, with repetitions."""
    yield from names_read(requirement.trigger)
    yield from names_read(requirement.consequent)
    for capture in requirement.captures:
        yield from names_in(capture.value)
    if requirement.for_each is not None:
        yield requirement.for_each.value.event


def names_of_spec(spec: CheckedSpec) -> Iterator[str]:
    """The names that requirements, properties and goals read, with repetitions."""
    for requirement in spec.requirements.values():
        yield from names_of_requirement(requirement)
    for found in spec.properties.values():
        yield from names_of_property(found.formula)
    formulas = [cover.formula for cover in spec.covers.values()]
    for point in spec.coverpoints.values():
        formulas += [bin_.formula for bin_ in point.bins]
    sampled = [point.upon for point in spec.coverpoints.values()]
    sampled += [cross.upon for cross in spec.crosses.values()]
    formulas += [formula for formula in sampled if formula is not None]
    for formula in formulas:
        yield from names_read(formula)


def names_of_property(formula: StateFormula) -> Iterator[str]:
    """The names of the spec that a property reads, with repetitions."""
    waiting = [formula]
    while waiting:
        match waiting.pop():
            case StateAtom(formula=inner):
                yield from names_read(inner)
            case StateNot(operand=operand) | PathUnary(operand=operand):
                waiting.append(operand)
            case StateBinary(left=left, right=right) | PathBinary(left=left, right=right):
                waiting += (right, left)
