"""The core against progression, on a few traces too long for the law."""

import pytest
from benchmarks.long_traces import compared, long_cases


@pytest.mark.law
def test_long_traces_are_judged_as_by_progression() -> None:
    """What attempts owe over a thousand samples is what progression makes of it, whoever judges."""
    found = compared(long_cases("test", 1_000), 40)
    assert found.samples == 40_000
    assert found.attempts["P"] > 100
    assert found.attempts["F"] > 100
    assert {"automaton", "network"} <= found.judges.keys()
    assert found.found == []
