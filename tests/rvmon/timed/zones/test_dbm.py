"""Operations on zones do to every valuation what they say, checked point by point."""

from fractions import Fraction
from itertools import product
from operator import le

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rvmon.timed.zones.dbm import (
    STRICT,
    bound_of,
    constrain,
    cover_test,
    delay,
    delay_within,
    normalise,
    passes,
    reset,
    universe,
)

pytestmark = pytest.mark.law

repeatable = settings(deadline=None, derandomize=True)

DIM = 3
POINTS = [(Fraction(0), Fraction(a, 2), Fraction(b, 2)) for a, b in product(range(9), range(9))]
"""Valuations of two clocks; zones with integer bounds differ on halves if they differ below 4."""

ATOMS = st.tuples(st.integers(0, 2), st.integers(0, 2), st.integers(-3, 3), st.booleans()).filter(
    lambda atom: atom[0] != atom[1]
)


def is_in(point, zone):
    """Whether a valuation satisfies every bound of a zone."""
    return all(
        point[y] - point[x] <= bound
        if bound == int(bound)
        else point[y] - point[x] < -(-bound // 1)
        for x in range(DIM)
        for y in range(DIM)
        if (bound := zone[x * DIM + y]) != float("inf")
    )


def zone_of(atoms):
    """The zone of some bounds, `None` if it is empty."""
    zone = universe(DIM)
    for x, y, number, strict in atoms:
        if not constrain(zone, DIM, x, y, bound_of(number, strict)):
            return None
    return normalise(zone)


def satisfies(point, atom):
    """Whether a valuation satisfies a bound as it was thrown."""
    x, y, number, strict = atom
    difference = point[y] - point[x]
    return difference < number if strict else difference <= number


ZONES = st.lists(ATOMS, max_size=4).map(zone_of).filter(lambda zone: zone is not None)


@repeatable
@given(st.lists(ATOMS, max_size=5))
def test_constrain_keeps_exactly_what_satisfies_all_bounds(atoms):
    """A zone holds the valuations that satisfy its bounds, and none is called empty wrongly."""
    zone = zone_of(atoms)
    for point in POINTS:
        expected = all(satisfies(point, atom) for atom in atoms)
        assert (zone is not None and is_in(point, zone)) == expected


@repeatable
@given(ZONES)
def test_zones_are_closed(zone):
    """Every bound is the tightest that the others imply."""
    for x, y, z in product(range(DIM), repeat=3):
        tidy = normalise([zone[x * DIM + y] + zone[y * DIM + z]])[0]
        assert zone[x * DIM + z] <= tidy


@repeatable
@given(ZONES, st.integers(1, 2), st.integers(0, 2))
def test_reset_moves_each_valuation(zone, clock, value):
    """After a reset the zone holds the moved valuations and no others."""
    moved = zone[:]
    reset(moved, DIM, clock, float(value))
    for point in POINTS:
        after = tuple(Fraction(value) if i == clock else v for i, v in enumerate(point))
        if is_in(point, zone):
            assert is_in(after, normalise(moved))
        if point[clock] != value:
            assert not is_in(point, moved)


@repeatable
@given(ZONES)
def test_delay_adds_all_later_valuations(zone):
    """After a delay every earlier valuation of a point on the way is known to be one."""
    later = zone[:]
    delay(later, DIM)
    for point in POINTS:
        on_the_way = any(
            is_in((Fraction(0), point[1] - step, point[2] - step), zone)
            for step in (Fraction(n, 4) for n in range(17))
            if point[1] >= step and point[2] >= step
        )
        if on_the_way:
            assert is_in(point, later)


@repeatable
@given(ZONES, st.lists(st.tuples(st.integers(1, 2), st.integers(0, 3)), max_size=2))
def test_delay_within_equals_delay_and_constrain(zone, uppers):
    """The fused operation gives what its two parts give one after the other."""
    fused, parts = zone[:], zone[:]
    bounds = [(clock, float(number)) for clock, number in uppers]
    possible = delay_within(fused, DIM, bounds)
    delay(parts, DIM)
    assert possible == all(constrain(parts, DIM, 0, clock, bound) for clock, bound in bounds)
    if possible:
        assert normalise(fused) == normalise(parts)


@repeatable
@given(ZONES, ZONES, st.integers(0, 3), st.integers(0, 3))
def test_inclusion_implies_simulation(zone, other, upper, lower):
    """What is included is simulated, whatever the bounds are."""
    uppers = [(0, 0.0), (1, -float(upper)), (2, -float(lower))]
    lowers = [(0, 0.0), (1, float(lower)), (2, float(upper))]
    if all(map(le, zone, other)):
        assert passes(other, cover_test(zone, DIM, uppers, lowers))


@repeatable
@given(ZONES, ZONES)
def test_simulation_without_bounds_is_always(zone, other):
    """Where no clock is compared with anything, every zone simulates every other."""
    assert passes(other, cover_test(zone, DIM, [(0, 0.0)], [(0, 0.0)]))


def test_strict_bounds_stay_exact_after_many_sums():
    """A bound that many strict ones add up to is still one strict bound of the right number."""
    assert normalise([5 - 300 * STRICT]) == [5 - STRICT]
