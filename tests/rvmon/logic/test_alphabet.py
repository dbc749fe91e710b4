"""Letters distinguish what the formula distinguishes, and no more."""

from tests.tools.build import eventually, no, p, requirement, two

from rvmon.logic.alphabet import alphabet_of
from rvmon.logic.formula import Factory
from rvmon.logic.lower import lower
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN


def alphabet(formula, **more):
    return alphabet_of(lower(requirement(formula, **more), Factory()).required)


def test_a_proposition_read_one_way_needs_two_digits():
    """Unknown is false for the lower bound and true for the upper bound."""
    found = alphabet(eventually(p))
    assert found.size == 2
    assert found.pessimistic[0][UNKNOWN] == found.pessimistic[0][FALSE]
    assert found.optimistic[0][UNKNOWN] == found.optimistic[0][TRUE]


def test_a_proposition_read_both_ways_needs_four():
    """Read as p and as not p, an unknown value differs from both known ones."""
    found = alphabet(two(eventually(p), "and", eventually(no(p))))
    assert found.size == 4
    digits = {*found.pessimistic[0], *found.optimistic[0]}
    assert len(digits) == 4
