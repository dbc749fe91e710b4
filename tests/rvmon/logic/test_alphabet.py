"""Letters tell apart what the formula can tell apart, and no more."""

from tests.tools.build import always, eventually, no, p, q, requirement, two

from rvmon.logic.alphabet import alphabet_of, holds
from rvmon.logic.formula import Factory, Sense
from rvmon.logic.lower import lower
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN


def alphabet(formula, **more):
    return alphabet_of(lower(requirement(formula, **more), Factory()).required)


def test_a_proposition_read_one_way_needs_two_digits():
    """Unknown is false to the pessimist and true to the optimist."""
    found = alphabet(eventually(p))
    assert found.size == 2
    assert found.pessimistic[0][UNKNOWN] == found.pessimistic[0][FALSE]
    assert found.optimistic[0][UNKNOWN] == found.optimistic[0][TRUE]


def test_a_proposition_read_both_ways_needs_four():
    """Read as p and as not p, an unknown value differs from both known ones in either run."""
    found = alphabet(two(eventually(p), "and", eventually(no(p))))
    assert found.size == 4
    digits = {*found.pessimistic[0], *found.optimistic[0]}
    assert len(digits) == 4


def test_an_ending_trigger_reads_unknown_as_not_false():
    """An unknown trigger has ended no episode, in either run; only the obligation is in doubt."""
    found = alphabet(eventually(q), whenever=p)
    place = [state.leaf for state in found.propositions].index(p)
    for weights in (found.pessimistic[place], found.optimistic[place]):
        truth = found.valuation(weights[UNKNOWN])[found.propositions[place]]
        assert not holds(Sense.KNOWN_FALSE, truth)
    worse = found.valuation(found.pessimistic[place][UNKNOWN])[found.propositions[place]]
    better = found.valuation(found.optimistic[place][UNKNOWN])[found.propositions[place]]
    assert (holds(Sense.FALSE, worse), holds(Sense.FALSE, better)) == (False, True)


def test_letters_are_numbered_without_gaps():
    formula = two(eventually(p), "and", two(always(q), "or", eventually(no(p))))
    found = alphabet(formula)
    digits = [
        {*worse, *better} for worse, better in zip(found.pessimistic, found.optimistic, strict=True)
    ]
    letters = sorted(first + second for first in digits[0] for second in digits[1])
    assert letters == list(range(found.size))
