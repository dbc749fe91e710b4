"""Formulas in the languages of the peers."""

import pytest
from benchmarks.peers.dialects import translate
from benchmarks.peers.ways import Question, answers, ask_oracle
from tests.tools.build import (
    compared,
    eventually,
    fall,
    following,
    held,
    no,
    once,
    p,
    previous,
    probe,
    q,
    rise,
    true,
    two,
    x,
)
from tests.tools.common_fragment import UntranslatableError, to_core
from tests.tools.each import each

from rvmon.language.checked.formula import Formula
from rvmon.language.checked.specification import TimeModel


@each(
    ("dialect", "formula", "text"),
    [
        ("REELAY_DISCRETE", two(p, "->", q), "(((not({v_p}))) or ({v_q}))"),
        ("REELAY_DISCRETE", once(p, 2, None), "(once[2:]({v_p}))"),
        ("REELAY_DISCRETE", once(p, 0, 0), "{v_p}"),
        ("REELAY_DISCRETE", compared(x, "<=", 1.5), "{v_x <= 1.5}"),
        ("REELAY_DENSE", two(p, "S", q, 0, 3), "(((({v_p}) or ({v_q}))) since[0:3] ({v_q}))"),
        ("RTAMT_DISCRETE", two(p, "U", q, 1, 2), "(((v_p > 0.5)) until[1:2] ((v_q > 0.5)))"),
        ("RTAMT_DISCRETE", previous(p), "(s_prev((v_p > 0.5)))"),
        ("MSTLO", eventually(no(p), 1, 4), "(F[1, 4]((!((v_p > 0.5)))))"),
        ("MSTLO", true, "(v_one > 0.5)"),
        ("SENTIL", following(p), "(next((v_p > 0.5)))"),
        ("SENTIL", once(p, 2, 3), "(once[2, 3]((v_p > 0.5)))"),
    ],
)
def test_text(dialect: str, formula: Formula, text: str) -> None:
    assert translate(formula, dialect) == text


@each(
    ("dialect", "formula"),
    [
        ("REELAY_DISCRETE", eventually(p, 0, 3)),
        ("REELAY_DENSE", rise(p)),
        ("RTAMT_DENSE", following(p)),
        ("MSTLO", eventually(p)),
        ("MSTLO", once(p, 0, 3)),
        ("RTAMT_DISCRETE", probe("updated", "p")),
        ("RTAMT_DISCRETE", compared(x, "==", 1)),
    ],
)
def test_refusal(dialect: str, formula: Formula) -> None:
    """What a peer cannot say is refused, not weakened."""
    with pytest.raises(UntranslatableError):
        translate(formula, dialect)


@each(
    "formula",
    [
        two(p, "R", q, 1, 3),
        two(p, "W", q, 0, 2),
        two(p, "M", q, 0, 2),
        two(p, "<->", q),
        two(p, "xor", q),
        rise(p),
        fall(p),
        held(p, 2),
    ],
)
def test_core(formula: Formula) -> None:
    columns = {
        "p": [True, True, True, False, True, False],
        "q": [False, True, True, False] + [True] * 2,
    }

    def judged(asked: Formula) -> list[bool | None]:
        return answers(Question(asked, columns, TimeModel.SAMPLED), ask_oracle)

    assert judged(to_core(formula)) == judged(formula)
