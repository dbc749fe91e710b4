"""The core against progression, on a few traces too long for the law."""

import pytest
from benchmarks.long_traces import compared, long_cases


@pytest.mark.law
def test_long_traces_are_judged_as_by_progression() -> None:
    """What an attempt owes over some thousands of samples is what progression makes of it."""
    found = compared(long_cases("test", 1_000), 4)
    assert found.samples >= 4_000
    assert sum(found.attempts.values()) > 20
    assert found.found == []
