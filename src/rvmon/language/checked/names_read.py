"""The names that formulas and specifications read, and the selection of requirements by name."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from rvmon.errors import RvmonError, UnknownNameError
from rvmon.language.checked import formula as rv
from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.properties import StateAtom, state_formulas
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.texts import did_you_mean


def names_read(formula: rv.Formula) -> Iterator[str]:
    """The names of the signals and events that a formula reads, with repetitions."""
    for part in subformulas(formula):
        match part:
            case rv.SignalAtom(name=name) | rv.EventAtom(name=name) | rv.ProbeAtom(name=name):
                yield name
            case rv.Compare(left=left, right=right):
                yield from names_in(left)
                yield from names_in(right)


def names_in(numeric: rv.Numeric) -> Iterator[str]:
    """The names of the signals and events that a number reads, with repetitions."""
    waiting = [numeric]
    while waiting:
        match waiting.pop():
            case rv.SignalValue(name=name) | rv.UpdateValue(name=name) | rv.FieldValue(event=name):
                yield name
            case rv.Arithmetic(args=args):
                waiting += args
            case rv.WindowValue() as window:
                for part in window.operands:
                    yield from names_read(part)


def names_of_requirement(requirement: Requirement) -> Iterator[str]:
    """The names that are needed to judge a requirement, with repetitions."""
    yield from names_read(requirement.trigger)
    yield from names_read(requirement.consequent)
    for capture in requirement.captures:
        yield from names_in(capture.value)
    if requirement.for_each is not None:
        yield requirement.for_each.value.event


def names_of_spec(spec: CheckedSpec) -> Iterator[str]:
    """The names that requirements, properties, goals and coverage read, with repetitions."""
    for requirement in spec.requirements.values():
        yield from names_of_requirement(requirement)
    for property_ in spec.properties.values():
        for part in state_formulas(property_.formula):
            if isinstance(part, StateAtom):
                yield from names_read(part.formula)
    for cover in spec.covers.values():
        yield from names_read(cover.formula)
    for _, names in names_of_coverage(spec):
        yield from names


def names_of_coverage(spec: CheckedSpec) -> Iterator[tuple[str, Iterator[str]]]:
    """Each coverpoint, and each cross with its own `upon`, with the names read by its formulas.

    Names may repeat; a cross does not repeat those of its coverpoints.
    """
    for point in spec.coverpoints.values():
        formulas = [bin_.formula for bin_ in point.bins]
        formulas += [] if point.upon is None else [point.upon]
        yield point.name, (name for formula in formulas for name in names_read(formula))
    for cross in spec.crosses.values():
        if cross.upon is not None:
            yield cross.name, names_read(cross.upon)


def several(names: Iterable[str] | None) -> tuple[str, ...] | None:
    """The given names as a tuple; `None` stands for all names.

    Raises:
        RvmonError: a single text was given, whose letters would be taken for names.
    """
    if isinstance(names, str):
        raise RvmonError(f"expected names, such as [{names!r}], found one text: {names!r}")
    return None if names is None else tuple(names)


def requirement_ids(spec: CheckedSpec, only: Iterable[str] | None) -> tuple[str, ...] | None:
    """The requested ids of requirements, checked; `None` stands for all.

    Raises:
        UnknownNameError: there is no such requirement.
        RvmonError: a single text was given instead of several names.
    """
    chosen = several(only)
    for name in chosen or ():
        if name not in spec.requirements:
            known = ", ".join(spec.requirements) or "none"
            raise UnknownNameError(f"no requirement `{name}`: there are {known}")
    return chosen


def labelled(
    spec: CheckedSpec,
    only: Iterable[str] | None,
    severities: Iterable[Collection[str]],
    tags: Iterable[Collection[str]],
) -> tuple[str, ...]:
    """The ids of the requirements that have a severity or tag of each list.

    Only the existing ids in `only` are considered; `None` stands for all.

    Raises:
        UnknownNameError: no requirement has one of the words, or none is left.
    """
    left = list(spec.requirements) if only is None else list(only)
    wanted = [("severity", one) for one in severities] + [("tag", one) for one in tags]
    for kind, words in wanted:
        of = {name: _labels(requirement, kind) for name, requirement in spec.requirements.items()}
        known = sorted(set().union(*of.values()))
        for word in words or [""]:
            if word not in known:
                listed = f"there are {', '.join(known)}" if known else f"none has a {kind}"
                meant = did_you_mean(word, known, listed)
                raise UnknownNameError(f"no requirement has the {kind} `{word}`: {meant}")
        left = [name for name in left if not of[name].isdisjoint(words)]
    if not left:
        labels = ", ".join(f"the {kind} {' or '.join(words)}" for kind, words in wanted)
        raise UnknownNameError(f"no requested requirement has {labels}")
    return tuple(left)


def _labels(requirement: Requirement, kind: str) -> set[str]:
    return set(requirement.tags) if kind == "tag" else {requirement.severity} - {""}


def source_names(spec: CheckedSpec, names: Iterable[str] | None) -> frozenset[str] | None:
    """The requested names of signals and events, checked; `None` stands for all.

    Raises:
        UnknownNameError: there is no such signal or event.
        RvmonError: a single text was given instead of several names.
    """
    given = several(names)
    chosen = None if given is None else frozenset(given)
    declared = [*spec.signals, *spec.events]
    for name in sorted((chosen or frozenset()).difference(declared)):
        meant = did_you_mean(name, declared, f"there are {', '.join(declared)}")
        raise UnknownNameError(f"no signal or event named `{name}`: {meant}")
    return chosen
