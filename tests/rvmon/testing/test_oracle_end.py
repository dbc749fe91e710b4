"""The end of a trace and its policies: worked out by hand from SEMANTICS 3."""

from typing import Any

import pytest
from tests.tools.build import always, eventually, following, no, p, q, requirement, two
from tests.tools.each import each

from rvmon.language.checked.formula import Formula
from rvmon.language.checked.specification import EndPolicy, TimeModel

SAMPLED = {"time": TimeModel.SAMPLED}
EVERY_3 = {"time": TimeModel.CLOCKED, "period": 3}


@each(
    ("formula", "told", "expected"),
    [
        # What the end settles is decided at the end.
        # Held: max(last sample, last advance - 1, the t of finish).
        (always(p), {"p": "1..1"}, "0 P 3 held"),
        # Sampled: `advance` moves no end, `finish` does.
        (always(p), {"p": "1", "advances": [6], **SAMPLED}, "0 P 0 held"),
        # An unbounded R counts as true if its window has opened.
        (always(p, 3), {"p": "1", "end": 2}, "0 I"),
        (always(p, 3), {"p": "1", "end": 3}, "0 P 3 held"),
        # Every other pending operator stays unknown.
        (two(p, "U", q), {"p": "1", "q": "0", "end": 5}, "0 I"),
        (always(p, 0, 9), {"p": "1", "end": 5}, "0 I"),
        # In negation normal form: below a negation U is an R, and R a U.
        (no(eventually(q)), {"q": "0", "end": 4}, "0 P 4 held"),
        (no(two(p, "U", q)), {"p": "1", "q": "0", "end": 4}, "0 P 4 held"),
        # (G p & G p) | (!G p & !G p): the first half holds to the end.
        (two(always(p), "<->", always(q)), {"p": "1", "q": "1", "end": 4}, "0 P 4 held"),
        # Recursively, at each known position: an unanswered p stays open, an answered does not.
        (always(two(p, "->", eventually(q))), {"p": "010", "q": "0", "end": 5}, "0 I"),
        # Unknown input is not made known by the end.
        (always(p), {"p": "1u1", "end": 5}, "0 I"),
    ],
)
def test_end_rule(judge: Any, formula: Formula, told: dict[str, Any], expected: str) -> None:
    """What has to hold always has held, if it was given the run; all else stays open."""
    assert judge(formula, **told) == [expected]


@each(
    ("policy", "formula", "told", "expected"),
    [
        ("strict", always(p), {"p": "1", "end": 5}, "0 I"),
        # weak: what is pending is true; strong: it is false.
        ("weak", eventually(p), {"p": "0", "end": 5}, "0 P 5 policy"),
        ("weak", following(p), {"p": "0", **SAMPLED}, "0 P 0 policy"),
        ("strong", eventually(p), {"p": "0", "end": 5}, "0 F 5 policy"),
        # In both directions of an equivalence the pending part is true, or false.
        ("weak", two(always(p), "<->", q), {"p": "1", "q": "0", "end": 5}, "0 P 5 policy"),
        # Recursively, at each known position.
        ("weak", always(two(p, "->", eventually(q))), {"p": "1", "q": "0"}, "0 P 0 policy"),
        # pass and fail settle it outright.
        ("pass", eventually(p), {"p": "0", "end": 5}, "0 P 5 policy"),
        ("fail", always(p), {"p": "1", "end": 5}, "0 F 5 policy"),
        # What the prefix decided stays.
        ("weak", eventually(p, 0, 3), {"p": "0", "end": 3}, "0 F 4"),
        ("pass", always(p), {"p": "1..0"}, "0 F 3"),
    ],
)
def test_policies(judge: Any, policy: str, formula: Formula, told: Any, expected: str) -> None:
    """`at end` settles what is pending, and nothing else."""
    assert judge(requirement(formula, at_end=EndPolicy(policy)), **told) == [expected]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("formula", "told", "expected"),
    [
        # Nothing is pending: p is unknown, and stays so.
        (p, {"p": "u"}, {}),
        # The window is over, one of its values was never known.
        (eventually(p, 0, 2), {"p": "0u0", "end": 9}, {}),
        # Pending, and unknown: true to the rest leaves p unknown, false decides against it.
        (two(p, "and", always(q)), {"p": "u", "q": "1", "end": 3}, {"strong": "0 F 3 policy"}),
        # p U q with p unknown at 1: a later q would be of no certain use.
        (two(p, "U", q), {"p": "1u1", "q": "0", "end": 3}, {"strong": "0 F 3 policy"}),
    ],
)
def test_policies_and_unknown_input(
    judge: Any, formula: Formula, told: Any, expected: dict[str, str]
) -> None:
    """No policy settles what is undecided for want of input."""
    for policy in EndPolicy:
        got = judge(requirement(formula, at_end=policy), **told)
        assert got == [expected.get(policy, "0 I")], policy


@each(
    ("policy", "rows", "expected"),
    [
        # Episode still running.
        ("strict", {"p": "1", "q": "1", "end": 5}, "0 I"),
        ("strong", {"p": "1", "q": "1", "end": 5}, "0 F 5 policy"),
        ("fail", {"p": "1", "q": "1", "end": 5}, "0 F 5 policy"),
        # Episode over, the deadline of its last instant open.
        ("default", {"p": "1..0", "q": "1..0"}, "0 P 3"),
        # The first instant at which it was not met in time is 1, known at 4.
        ("weak", {"p": "1..0", "q": "10"}, "0 F 4"),
    ],
)
def test_policies_of_episodes(judge: Any, policy: str, rows: Any, expected: str) -> None:
    """A running episode is a pending obligation."""
    required = requirement(eventually(q, 0, 2), whenever=p, at_end=EndPolicy(policy))
    assert judge(required, **rows) == [expected]


@each("time", [{}, SAMPLED, EVERY_3])
@each(
    ("formula", "told", "expected"),
    [
        (always(p, 0, 0), {"p": "1"}, "0 P 1"),
        (eventually(q, 0, 3), {"q": "0..0"}, "0 F 4"),
        (eventually(q, 0, 3), {"q": "0", "end": 3}, "0 F 4"),
        (eventually(q, 0, 3), {"q": "0", "end": 2}, "0 I"),
        (eventually(q, 0, 3), {"q": "0", "end": 3, "advances": [9]}, "0 F 4"),
    ],
)
def test_finish_is_an_advance_behind_the_end(
    judge: Any, time: Any, formula: Formula, told: dict[str, Any], expected: str
) -> None:
    """A window that ends at the end, or before it, is over."""
    assert judge(formula, **told, **time) == [expected]
