"""The page about other monitors holds what the benchmark runs."""

from pathlib import Path

import pytest
from benchmarks.peers.differences import DIFFERENCES

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "other-monitors.md"


@pytest.mark.parametrize("difference", DIFFERENCES, ids=lambda one: f"{one.peer[0]}: {one.formula}")
def test_every_difference_stands_on_the_page(difference):
    rows = [row for row in PAGE.read_text().splitlines() if row.startswith("|")]
    [row] = [row for row in rows if difference.reading in row and difference.formula in row]
    assert difference.peer[0].removesuffix("-python") in row
