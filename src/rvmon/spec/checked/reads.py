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
    for cover in spec.covers.values():
        yield from names_read(cover.formula)
    for _, names in names_of_coverage(spec):
        yield from names


def names_of_coverage(spec: CheckedSpec) -> Iterator[tuple[str, Iterator[str]]]:
    """Each coverpoint and cross, and the names that it reads itself, with repetitions."""
    for point in spec.coverpoints.values():
        asked = [bin_.formula for bin_ in point.bins]
        asked += [] if point.upon is None else [point.upon]
        yield point.name, (name for formula in asked for name in names_read(formula))
    for cross in spec.crosses.values():
        if cross.upon is not None:
            yield cross.name, names_read(cross.upon)


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
