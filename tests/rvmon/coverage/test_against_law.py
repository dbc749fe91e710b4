"""Random coverpoints and crosses against their definition; `benchmarks` does the same for hours."""

from collections import Counter

import pytest
from tests.tools.coverage import judge


@pytest.mark.parametrize("seed", [f"tests/{number}" for number in range(60)])
def test_random_bins(seed):
    """In all time models, with dropouts and names without a source."""
    tally = Counter()
    assert judge(seed, 4, tally) == []
    assert tally["pairs"] == 4
