"""Reduced automata are smaller and behave the same."""

from bisect import bisect_right

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.tools.build import always, eventually, false, no, p, q, r, requirement, two
from tests.tools.each import each

from rvmon.logic.alphabet import alphabet_of
from rvmon.logic.automaton import PASSED, Automaton, Token
from rvmon.logic.construct import Budget, DoesNotCloseError, construct
from rvmon.logic.formula import Factory
from rvmon.logic.lower import lower
from rvmon.logic.reduce import reduce
from rvmon.logic.state_formula import FALSE, UNKNOWN
from rvmon.monitor.obligation_words import Words
from rvmon.testing.generate.numbers import Shape
from rvmon.testing.strategies import formulas


def built(formula, **more):
    factory = Factory()
    obligation = lower(requirement(formula, **more), factory)
    automaton = construct(
        factory.next(obligation.required), alphabet_of(obligation.required), Budget()
    )
    return automaton, Words(obligation.origins, formula).label


def nothing(_residual) -> None:
    """A label that distinguishes no locations."""


def rows(automaton: Automaton) -> int:
    return len(automaton.time_values)


class TableMachine:
    """A running automaton.

    A token is a location with the start instant of each clock. A row is a
    location with a region for each clock.
    """

    def __init__(self, automaton: Automaton) -> None:
        self.automaton = automaton
        self.start: Token = (automaton.initial, ())

    def row(self, token: Token, t: int) -> int:
        """The row of a token at `t`."""
        location, anchors = token
        cuts, strides = self.cuts(location), self.automaton.strides[location]
        regions = (bisect_right(cuts[k], t - anchor) for k, anchor in enumerate(anchors))
        steps = (region * stride for region, stride in zip(regions, strides, strict=True))
        return self.automaton.bases[location] + sum(steps)

    def step(self, token: Token, t: int, letter: int) -> Token:
        """The token after a position at `t`."""
        one = self.automaton
        edge = one.edges[self.row(token, t) * one.classes + one.class_of[letter]]
        anchors = tuple(t if source < 0 else token[1][source] for source in one.sources[edge])
        return one.targets[edge], anchors

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """For each clock of a location the ages from which it behaves differently."""
        return self.automaton.locations[location].cuts

    def time_value(self, token: Token, t: int) -> int:
        """The truth when time has reached `t` without a position."""
        return self.automaton.time_values[self.row(token, t)]


def walk(automaton, word):
    """The decision and its instant; the truth over time and at the end for every step."""
    machine = TableMachine(automaton)
    token, seen = machine.start, []
    for t, letter, gap in word:
        token = machine.step(token, t, letter % automaton.alphabet.size)
        if token[0] <= PASSED:
            return [*seen, (t, token[0])]
        seen += [machine.time_value(token, later) for later in range(t, t + gap + 1)]
        if seen[-1] != seen[0]:  # decided by time alone
            return seen
    row = machine.row(token, word[-1][0])
    return [*seen, automaton.end_values[row]]


WORDS = st.lists(st.tuples(st.integers(0, 10**6), st.integers(1, 5)), min_size=1, max_size=8)


@pytest.mark.law
@settings(max_examples=150, deadline=None)
@given(data=st.data(), steps=WORDS)
def test_a_reduced_automaton_decides_the_same(data, steps):
    formula = data.draw(formulas(Shape(mixed=False, step=True)))
    try:
        original, told = built(formula)
    except DoesNotCloseError:
        assume(False)
    word, t = [], 0
    for letter, gap in steps:
        word.append((t, letter, gap - 1))
        t += gap
    expected = walk(original, word)
    labelled = reduce(original, told)
    texts = [{told(place.residual) for place in one.locations} for one in (original, labelled)]
    assert texts[0] == texts[1], "what people are told stays"
    for small in (labelled, reduce(original, nothing)):
        assert walk(small, word) == expected
        assert len(small.locations) <= len(original.locations)
        assert rows(small) <= rows(original)


@pytest.mark.slow
@each(
    "formula",
    [
        always(two(p, "U", two(q, "U", r, 2, 4), 1, 5)),
        two(always(eventually(r), 3), "U", q, 3, None),
    ],
)
def test_equivalent_locations_are_one(formula):
    """Locations that differ only in their text are merged if no text is requested."""
    original, told = built(formula)
    some = (reduce(original, nothing), reduce(original, told), original)
    sizes = [len(one.locations) for one in some]
    assert sizes[0] < sizes[2]
    assert sizes[0] <= sizes[1] <= sizes[2]


def test_locations_that_time_decides_stay_distinct():
    """`F[0,3] false` is decided by time, `G[4, inf) false` by a position; moves are equal."""
    by_time = two(p, "and", eventually(false, 0, 3))
    by_position = two(always(false, 4), "and", eventually(q, 9))
    original, _ = built(two(by_time, "or", two(no(p), "and", by_position)))
    small = reduce(original, nothing)
    machine = TableMachine(small)
    values = set()
    for letter in range(small.alphabet.size):
        token = machine.step(machine.start, 0, letter)
        if token[0] > PASSED:
            values.add(machine.time_value(token, 4))
    assert values == {UNKNOWN, FALSE}
