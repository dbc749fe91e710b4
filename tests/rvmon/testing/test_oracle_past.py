"""Past operators and connectives, each expected value worked out by hand from SEMANTICS 2."""

from typing import Any

import pytest
from tests.tools.build import (
    always,
    e,
    eventually,
    fall,
    held,
    historically,
    no,
    once,
    p,
    previous,
    q,
    requirement,
    rise,
    true,
    two,
)
from tests.tools.each import each

from rvmon.language.checked.formula import Formula
from rvmon.language.checked.specification import TimeModel

SAMPLED = {"time": TimeModel.SAMPLED}


@each(
    ("formula", "rows", "expected"),
    [
        # `rise` and `fall` compare with the position before.
        # At the first position Y is false, rise(φ) is φ, fall(φ) is false.
        (previous(p), {"p": "1", "e": "1"}, "0 F 0"),
        # In held time "before" is the tick before.
        (rise(p), {"p": "0.1", "e": "..1"}, "2 P 2"),
        (fall(p), {"p": "1.0", "e": "..1"}, "2 P 2"),
        (fall(p), {"p": "1.0", "e": "...1"}, "3 F 3"),
        (rise(p), {"p": "u.1", "e": "..1"}, "2 P 2"),
        # `O` and `H` look back over the held trace, also before the trigger.
        # p at 0 only, judged at 3.
        (once(p, 0, 2), {"p": "10", "e": "...1"}, "3 F 3"),
        # Over nothing once is false and historically true.
        (once(p, 4, 9), {"p": "1", "e": "...1"}, "3 F 3"),
        # `p S[a,b] q` is `U` mirrored: q back in the window, and p at every instant after it.
        # q at 0 only, p from 1 on: the left operand is required behind q, up to now.
        (two(p, "S", q), {"p": "01", "q": "10", "e": "...1"}, "3 P 3"),
        # q now needs no p.
        (two(p, "S", q), {"p": "0", "q": "1", "e": "...1"}, "3 P 3"),
        # q at 1 and 2: with a = 2 only 1 counts, and p is required at 2 and 3.
        (two(p, "S", q, 2, None), {"p": "0.1", "q": "01.0", "e": "...1"}, "3 P 3"),
        (two(p, "S", q, 2, None), {"p": "0..1", "q": "01.0", "e": "...1"}, "3 F 3"),
        # `held(p, 2)`: p now and for two ticks back, and at least two since the start.
        (held(p, 2), {"p": "1", "e": "..1"}, "2 P 2"),
        # Not yet two ticks since the start, though p was never false.
        (held(p, 2), {"p": "1", "e": ".1"}, "1 F 1"),
        # The start is the first sample, not zero.
        (held(p, 2), {"p": ".1", "e": "...1"}, "3 P 3"),
        # In `sampled` time they see samples only: the one before, however long ago.
        (previous(p), {"p": "1...0", "e": "....1", **SAMPLED}, "4 P 4"),
    ],
)
def test_past(judge: Any, formula: Formula, rows: Any, expected: str) -> None:
    """Operators of the past, asked where `e` occurs."""
    assert judge(requirement(formula, upon=e), **rows) == [expected]


@pytest.mark.parametrize(
    ("formula", "rows", "expected"),
    [
        # G[0,2] O[0,1] p: at 2 it needs p at 1 or 2.
        (always(once(p, 0, 1), 0, 2), {"p": "10.", "end": 3}, "0 F 2"),
        # O[2,2] F[0,1] p at 3 looks at 1 and 2.
        (eventually(once(eventually(p, 0, 1), 2, 2), 3, 3), {"p": "0.1"}, None),
        # H[0,1] F[0,2] p at 0: one position; p by 2.
        (historically(eventually(p, 0, 2), 0, 1), {"p": "0.1"}, "0 P 2"),
        (historically(eventually(p, 0, 2), 0, 1), {"p": "0..1"}, "0 F 3"),
        # `start` is true at the first position only.
        (true, {"p": "01"}, "0 P 0"),
    ],
)
def test_past_and_future(judge: Any, formula: Formula, rows: Any, expected: str | None) -> None:
    """Past and future operators nest either way."""
    assert judge(formula, **rows) == [expected or "0 I"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("op", "table"),
    [
        # Rows: p = 0, u, 1; columns: q = 0, u, 1.
        ("and", ["FFF", "FII", "FIP"]),
        ("or", ["FIP", "IIP", "PPP"]),
        ("->", ["PPP", "IIP", "FIP"]),
        ("<->", ["PIF", "III", "FIP"]),
        ("xor", ["FIP", "III", "PIF"]),
    ],
)
def test_connectives(judge: Any, op: str, table: list[str]) -> None:
    """The connectives are Kleene's."""
    for p_value, row in zip("0u1", table, strict=True):
        for q_value, expected in zip("0u1", row, strict=True):
            instant = "" if expected == "I" else " 0"
            got = judge(two(p, op, q), p=p_value, q=q_value)
            assert got == [f"0 {expected}{instant}"], (p_value, q_value)


def test_no_rule_of_the_excluded_middle(judge: Any) -> None:
    """An unknown `p or not p` is unknown: no operator looks at two operands at once."""
    assert judge(two(p, "or", no(p)), p="u") == ["0 I"]
