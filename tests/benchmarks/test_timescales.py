"""The Timescales families."""

import pytest
from benchmarks.peers.ways import Question, answers, ask_oracle
from benchmarks.timing.timescales import FAMILIES, Family, trace
from benchmarks.timing.workload import formula

from rvmon.language.checked.specification import TimeModel

pytestmark = pytest.mark.slow

HIGH = 6


@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)
def test_forms(family: Family) -> None:
    """The past form holds at every row but the last; the future one fails at the end alone."""
    columns = trace(family, HIGH, 60)
    past, future = (
        answers(Question(formula(family.text(tense, HIGH)), columns, TimeModel.SAMPLED), ask_oracle)
        for tense in ("past", "future")
    )
    assert past == [True] * (len(past) - 1) + [False]
    assert False not in future[: -2 * HIGH]
    assert True in future


def test_length_and_seed() -> None:
    """A trace has about the rows that were asked for, and is the same for the same seed."""
    for family in FAMILIES.values():
        columns = trace(family, HIGH, 500)
        assert set(columns) == set(family.names)
        assert {len(column) for column in columns.values()} == {len(columns["p"])}
        assert 500 - 3 * HIGH <= len(columns["p"]) <= 500 + 10 * HIGH
        assert columns == trace(family, HIGH, 500)
        assert family.name == "RecurGLB" or columns != trace(family, HIGH, 500, seed=2)
