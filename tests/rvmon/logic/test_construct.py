"""Construction of automata: their size, and what fits the budget."""

import pytest
from tests.tools.build import always, eventually, no, p, q, r, requirement, two
from tests.tools.each import each

from rvmon.language.checked.formula import SignalAtom
from rvmon.logic.alphabet import LetterDiagram, alphabet_of
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.formula import Factory
from rvmon.logic.lower import lower
from rvmon.logic.reduce import reduce

SECOND = 10**9


def core(formula, **more):
    factory = Factory()
    required = lower(requirement(formula, **more), factory).required
    return factory.next(required), alphabet_of(required)


def build(formula, budget=None, **more):
    return construct(*core(formula, **more), budget or Budget())


@each(
    ("formula", "whenever", "locations", "clocks", "classes"),
    [
        (eventually(p, 0, 3 * SECOND), None, 4, 1, 2),
        (always(no(p), 0, 2 * SECOND), None, 4, 1, 2),
        (p, q, 4, 0, 4),
        (two(p, "->", eventually(q, 0, 5)), None, 4, 1, 4),
        (two(p, "->", always(r, 0, 3 * SECOND)), q, 6, 1, 7),
    ],
)
def test_usual_requirements_stay_small(formula, whenever, locations, clocks, classes):
    """Requirements as people write them need few locations and at most one clock."""
    automaton = build(formula, **({"whenever": whenever} if whenever else {}))
    assert len(automaton.locations) <= locations
    assert automaton.clocks == clocks
    assert automaton.classes <= classes


def test_many_propositions_do_not_make_many_classes():
    names = [SignalAtom(f"s{number}") for number in range(12)]
    formula = eventually(names[0], 0, 9)
    for name in names[1:]:
        formula = two(formula, "or", eventually(name, 0, 9))
    automaton = build(formula)
    assert automaton.alphabet.size == 2**12
    assert automaton.classes == 2


@each("high", [None, 5])
def test_conjunctions_of_recurring_demands_close(high):
    """A location is the set of obligations left of three, whatever path leads there."""
    demands = two(eventually(p, 0, high), "and", eventually(q, 0, high))
    demands = two(demands, "and", eventually(r, 0, high))
    assert build(always(demands)).clocks == (0 if high is None else 3)


def test_respawned_windows_do_not_close():
    """Windows that start above zero and are reopened exceed the budget, which is reported."""
    with pytest.raises(DoesNotCloseError, match="more than"):
        build(always(two(p, "->", eventually(q, 20, 50))))


@pytest.mark.slow
def test_letters_beyond_a_table_are_looked_up_in_a_diagram():
    names = [SignalAtom(f"s{number}") for number in range(18)]
    formula = eventually(names[0], 0, 1)
    for number, name in enumerate(names[1:], 2):
        formula = two(formula, "or", eventually(name, 0, number))
    required, alphabet = core(formula)
    automaton = reduce(construct(required, alphabet, Budget()), lambda residual: residual)
    assert alphabet.size == 2**18
    assert isinstance(automaton.class_of, LetterDiagram)
    assert automaton.classes == 19
