"""The Timescales families."""

from __future__ import annotations

import pytest
from benchmarks.peers.ways import Question, answers, ask_oracle
from benchmarks.timing.timescales import FAMILIES, Family, trace
from benchmarks.timing.workload import formula

from rvmon.spec.checked.specification import TimeModel

HIGH = 6


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_past_form(family: Family) -> None:
    """The past form holds at every row of a trace but the last."""
    columns = trace(family, HIGH, 60)
    asked = formula(family.text("past", HIGH))
    found = answers(Question(asked, columns, TimeModel.SAMPLED), ask_oracle)
    assert found[:-1] == [True] * (len(found) - 1)
    assert found[-1] is False


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_future_form(family: Family) -> None:
    """The future form is false nowhere before the violation at the end."""
    columns = trace(family, HIGH, 60)
    asked = formula(family.text("future", HIGH))
    found = answers(Question(asked, columns, TimeModel.SAMPLED), ask_oracle)
    assert False not in found[: -2 * HIGH]
    assert True in found


def test_length_and_seed() -> None:
    """A trace has about the rows that were asked for, and is the same for the same seed."""
    for family in FAMILIES:
        columns = trace(family, HIGH, 500)
        assert set(columns) == set(family.names)
        assert {len(column) for column in columns.values()} == {len(columns["p"])}
        assert 500 - 3 * HIGH <= len(columns["p"]) <= 500 + 10 * HIGH
        assert columns == trace(family, HIGH, 500)
        assert family.name == "RecurGLB" or columns != trace(family, HIGH, 500, seed=2)
