"""Automata of the same shape are constructed once."""

from collections.abc import Iterator
from random import Random

import pytest
from tests.tools.build import scaled

from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.logic.alphabet import Alphabet, LetterDiagram, alphabet_of
from rvmon.logic.automaton import Automaton, end_clauses
from rvmon.logic.automaton_shapes import Shapes
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.formula import Factory, Next
from rvmon.logic.lower import Obligation, lower
from rvmon.logic.reduce import reduce
from rvmon.testing.generate.spec import Profile, random_spec

BUDGET = Budget(locations=30, clocks=3, rows=200, clauses=12)


def required_by(requirement: Requirement, factory: Factory) -> Iterator[tuple[Next, Alphabet]]:
    """The obligations of a requirement's attempts, including those in doubt."""
    obligation: Obligation | None = lower(requirement, factory)
    while obligation is not None:
        yield factory.next(obligation.required), alphabet_of(obligation.required)
        obligation = obligation.hidden


def tables(automaton: Automaton | None) -> object:
    if automaton is None:
        return None
    classes = automaton.class_of
    return (
        automaton.initial,
        automaton.classes,
        classes.root if isinstance(classes, LetterDiagram) else classes,
        (automaton.bases, automaton.strides, automaton.edges),
        (automaton.targets, automaton.sources),
        (automaton.time_values, automaton.end_values),
        [(place.cuts, end_clauses(place.residual)) for place in automaton.locations],
    )


def constructed(required: Next, alphabet: Alphabet) -> Automaton | None:
    try:
        return reduce(construct(required, alphabet, BUDGET), lambda residual: residual)
    except DoesNotCloseError:
        return None


@pytest.mark.law
@pytest.mark.parametrize("part", range(3))
def test_an_automaton_of_a_known_shape_is_that_of_its_formula(part):
    shapes = Shapes()
    found = []
    for seed in range(20 * part, 20 * (part + 1)):
        spec = random_spec(Random(seed), Profile(mixed=False, captures=False, for_each=False))
        # One tick more or less changes the first of them only.
        for factor in (1, 500, 1_000_000, 7_000_001):
            for required, alphabet in _retimed(spec, factor):
                made = shapes.reduced(required, alphabet, BUDGET)
                alone = constructed(required, alphabet)
                assert tables(made) == tables(alone)
                if alone is not None:
                    owing = [place.residual for place in alone.locations]
                    assert shapes.residuals(required, alphabet, BUDGET) == owing
                found.append(made)
    assert sum(made is not None for made in found) >= 100


def _retimed(spec: CheckedSpec, factor: int) -> Iterator[tuple[Next, Alphabet]]:
    factory = Factory()
    for one in spec.requirements.values():
        formulas = [scaled(part, factor) for part in (one.trigger, one.consequent)]
        yield from required_by(Requirement(one.id, one.mode, *formulas, pulse=one.pulse), factory)
