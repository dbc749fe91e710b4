"""Formulas of a specification become core formulas."""

import pytest
from tests.tools.build import (
    always,
    compared,
    e,
    eventually,
    following,
    no,
    once,
    p,
    q,
    r,
    requirement,
    two,
    x,
)
from tests.tools.each import each

import rvmon
from rvmon.logic.formula import Factory, Literal, Since, Until, horizon
from rvmon.logic.lower import UnmonitorableError, lower


def required(formula, **more):
    return lower(requirement(formula, **more), Factory()).required


def test_equal_meanings_become_one_object():
    """Duals and De Morgan variants of a formula are the same node of a factory."""
    factory = Factory()
    pairs = [
        (no(eventually(p, 0, 3)), always(no(p), 0, 3)),
        (no(two(p, "U", q, 1, 4)), two(no(p), "R", no(q), 1, 4)),
        (two(p, "W", q), two(q, "R", two(p, "or", q))),
        (two(p, "M", q), two(q, "U", two(p, "and", q))),
        (no(two(p, "and", eventually(q))), two(no(p), "or", always(no(q)))),
        (two(p, "->", eventually(q)), two(no(p), "or", eventually(q))),
        (no(two(p, "xor", eventually(q))), no(no(no(two(p, "xor", eventually(q)))))),
    ]
    for left, right in pairs:
        first = lower(requirement(left), factory).required
        assert first is lower(requirement(right), factory).required


def test_present_and_past_become_one_proposition():
    """Formulas known at once stay whole, which keeps the number of letters small."""
    node = required(
        eventually(two(two(p, "and", no(q)), "or", once(compared(x, ">", 1), 0, 5)), 0, 3)
    )
    assert isinstance(node, Until)
    assert isinstance(node.right, Literal)


@each(
    ("formula", "ticks"),
    [
        (p, 0),
        (eventually(p, 1, 3), 3),
        (two(always(p, 0, 4), "U", eventually(q, 2, 5), 0, 7), 12),
        (two(eventually(p, 0, 9), "and", always(r, 0, 3)), 9),
        (eventually(p), None),
        (following(p), None),
    ],
)
def test_horizon(formula, ticks):
    """The horizon is the sum of nested bounds; there is none with an unbounded operator."""
    assert horizon(required(formula)) == ticks


def test_a_trigger_about_the_future_is_refused():
    """Its truth is not known at once; a consequent may have future operators anywhere."""
    with pytest.raises(UnmonitorableError):
        required(p, upon=once(eventually(p, 0, 2), 0, 3))
    assert isinstance(required(once(eventually(p, 0, 2), 0, 3), upon=e), Since)


@pytest.mark.slow
def test_nested_equivalences_take_no_time():
    """The expansion of `<->` has each operand twice, yet each is lowered once."""
    nested = "p"
    for _ in range(30):
        nested = f"(q <-> {nested})"
    head = "spec s\nsignal p, q : bool\nrequirement R\n  upon"
    spec = rvmon.loads(f"{head} {nested} then {nested}\n")
    run = [(0, {"p": False, "q": False}), (10, {"p": True})]
    assert spec.evaluate(run).verdicts == {"R": rvmon.Verdict.PASS}
