"""The table of what whole files take."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from benchmarks.files import measure_files
from benchmarks.peers.environment import Environment


@pytest.mark.process
def test_all_ways_find_the_same_failures(tmp_path: Path) -> None:
    """Each way has a line, with a ratio as its failures are the first's; who is absent is named."""
    absent = Environment(Path(sys.executable), {}, {"duckdb": "not on this index"})
    lines = list(measure_files(30_000, 2, 1, absent, tmp_path))
    assert lines[-1] == "Not measured: DuckDB, 30,000 rows: not on this index."
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines[2:-2]]
    assert len(cells) == 13
    assert [ratio.endswith("×") for *_, ratio, _ in cells].count(True) == 8
    assert not any("others" in failures for *_, failures in cells)
    assert any(failures not in ("0", "–") for *_, failures in cells)
