"""Future operators, each expected value worked out by hand from SEMANTICS 2.

A row draws one name, a character per tick from 0. `0 P 3`: triggered at 0, passed at 3.
"""

from typing import Any

import pytest
from tests.tools.build import always, eventually, following, no, p, q, two
from tests.tools.each import each

from rvmon.language.checked.formula import Formula
from rvmon.language.checked.specification import TimeModel

SAMPLED = {"time": TimeModel.SAMPLED}
EVERY_3 = {"time": TimeModel.CLOCKED, "period": 3}


UNTIL, WEAK, STRONG = two(p, "U", q, 2, 4), two(p, "W", q, 0, 3), two(p, "M", q, 0, 3)


@pytest.mark.slow
@each(
    ("formula", "told", "expected"),
    [
        # `F[a,b]` is met in its window, missed at b + 1, open until then.
        # The last instant of the window still counts; the tick after it decides.
        (eventually(p, 0, 3), {"p": "0..1"}, "0 P 3"),
        (eventually(p, 0, 3), {"p": "0...1"}, "0 F 4"),
        # A trace that ends at the deadline has missed it; one that ends before leaves it open.
        (eventually(p, 0, 3), {"p": "0", "end": 3}, "0 F 4"),
        (eventually(p, 0, 3), {"p": "0", "end": 2}, "0 I"),
        # A timer decides as well as a message, and at the same instant.
        (eventually(p, 0, 3), {"p": "0", "advances": [3]}, "0 I"),
        (eventually(p, 0, 3), {"p": "0", "advances": [4]}, "0 F 4"),
        # What is held counts between samples, from the opening of the window on.
        (eventually(p, 2, 3), {"p": "1", "end": 9}, "0 P 2"),
        # A window of one point.
        (eventually(p, 0, 0), {"p": "1"}, "0 P 0"),
        # Without an upper bound nothing is ever missed.
        (eventually(p), {"p": "0", "end": 50}, "0 I"),
        # An unknown value is neither: the window may still be met, else it stays open.
        (eventually(p, 0, 3), {"p": "u.1"}, "0 P 2"),
        # `G[a,b]` fails where its operand does, and holds at b + 1.
        (always(p, 0, 3), {"p": "1", "end": 3}, "0 P 4"),
        (always(p, 0, 3), {"p": "1..0"}, "0 F 3"),
        # `p U[2,4] q` needs q in the window and p at every instant before it.
        (UNTIL, {"p": "1", "q": "0..1"}, "0 P 3"),
        # The left operand is required from the start on, also before the window opens.
        (UNTIL, {"p": "01", "q": "0..1"}, "0 F 0"),
        # It is not required where the right one is met.
        (UNTIL, {"p": "1.0", "q": "0.1"}, "0 P 2"),
        # Met before the window is not met.
        (UNTIL, {"p": "1", "q": "010", "end": 9}, "0 F 5"),
        # The bound itself, the tick after it, the end at the bound.
        (UNTIL, {"p": "1", "q": "0...1"}, "0 P 4"),
        (UNTIL, {"p": "1", "q": "0....1"}, "0 F 5"),
        # An unknown left operand leaves it open, a false one behind it does not.
        (UNTIL, {"p": "1u1", "q": "0..1", "end": 9}, "0 I"),
        # An unknown right operand may have been it, but a later sure one is.
        (UNTIL, {"p": "1", "q": "0.u1"}, "0 P 3"),
        # `p U q` is met at once by q, fails as p ends before, and is open for ever else.
        (two(p, "U", q), {"p": "0", "q": "1"}, "0 P 0"),
        # `p W[0,3] q` is `q R[0,3] (p | q)`: p, for 3 ticks or until q.
        (WEAK, {"p": "1", "q": "0", "end": 3}, "0 P 4"),
        (WEAK, {"p": "10", "q": "0.1"}, "0 F 1"),
        # `p M[0,3] q` is `q U[0,3] (p & q)`: q up to p, with it, and p within 3 ticks.
        (STRONG, {"p": "0.1", "q": "1"}, "0 P 2"),
        (STRONG, {"p": "0", "q": "1", "end": 3}, "0 F 4"),
        # Nested operators are decided as soon as their operands leave one value:
        # F[0,2] G[0,2] p: p from 1 to 3 makes G true at 1, known at 4.
        (eventually(always(p, 0, 2), 0, 2), {"p": "01..0"}, "0 P 4"),
        # p only on 1 and 2, then on 4 ...: G fails at 0 (0), 1 (3), 2 (3), the last at 3.
        (eventually(always(p, 0, 2), 0, 2), {"p": "01.01", "end": 9}, "0 F 3"),
        # G[0,2] F[0,1] p: at 0 by 1, at 1 by 1, at 2 it needs 2 or 3.
        (always(eventually(p, 0, 1), 0, 2), {"p": "010.", "end": 9}, "0 F 4"),
        # (p U[0,2] q) at 0 or 3 ticks later.
        (eventually(two(p, "U", q, 0, 2), 3, 3), {"p": "0..1", "q": "0....1"}, "0 P 5"),
    ],
)
def test_held(judge: Any, formula: Formula, told: dict[str, Any], expected: str) -> None:
    """In `held` time every tick is a position."""
    assert judge(formula, **told) == [expected]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("low", "told", "expected"),
    [
        (0, {"p": "0", "q": "1", "end": 3}, "0 P 4"),
        # p releases q behind itself, not where it stands.
        (0, {"p": "0.1", "q": "1..0"}, "0 P 2"),
        (0, {"p": "0..1", "q": "1..0"}, "0 F 3"),
        # Before the window opens, q is not required, and p releases it for good.
        (2, {"p": "10", "q": "0"}, "0 P 0"),
    ],
)
def test_release(judge: Any, low: int, told: dict[str, Any], expected: str) -> None:
    """`p R[a,3] q` is `!(!p U[a,3] !q)`."""
    assert judge(two(p, "R", q, low, 3), **told) == [expected]
    dual = no(two(no(p), "U", no(q), low, 3))
    assert judge(dual, **told) == [expected]


@each(
    ("formula", "told", "expected"),
    [
        # Bounds measure stamps; a missed deadline is decided at b + 1 though no sample is there.
        (eventually(p, 0, 3), {"p": "0....1"}, "0 F 4"),
        # Between samples there is no position: over an empty window F is false and G true.
        (eventually(p, 1, 2), {"p": "1..1"}, "0 F 3"),
        # A sample may still come at the very instant that `advance` names.
        (eventually(p, 0, 2), {"p": "0.1", "advances": [2]}, "0 P 2"),
        # X is the next sample, whenever it comes; `finish` makes none.
        (following(p), {"p": "0.1"}, "0 P 2"),
        (always(two(p, "->", following(q)), 0, 3), {"p": "1.0", "q": "0.1", "end": 9}, "0 P 4"),
    ],
)
def test_sampled(judge: Any, formula: Formula, told: dict[str, Any], expected: str) -> None:
    """In `sampled` time the samples alone are positions."""
    assert judge(formula, **told, **SAMPLED) == [expected]


@each(
    ("formula", "told", "expected"),
    [
        # Positions are 3, 6, 9 ... from the first multiple at or after the first sample.
        (p, {"p": ".1"}, None),
        (p, {"p": ".1", "advances": [4]}, "3 P 3"),
        # Signals by hold: only what holds at a multiple is seen.
        (p, {"p": ".1.0"}, "3 F 3"),
        # The window [3,7] holds 3 and 6, and is over at 8, between two ticks of the clock.
        (eventually(p, 0, 4), {"p": ".0", "end": 6}, "3 I"),
        (eventually(p, 0, 4), {"p": ".0", "end": 7}, "3 F 8"),
    ],
)
def test_clocked(judge: Any, formula: Formula, told: dict[str, Any], expected: str | None) -> None:
    """In `sampled every 3` the multiples of 3 are positions, up to the end."""
    assert judge(formula, **told, **EVERY_3) == ([] if expected is None else [expected])
