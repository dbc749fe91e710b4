"""The table of what whole files take."""

import io
import sys
from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import pytest
from benchmarks.peers.environment import Environment
from benchmarks.process import Cost
from benchmarks.timing import files
from benchmarks.timing.workload import QUICK

from rvmon.cli import main


def in_this_process(command: Sequence[str], **_: object) -> Cost:
    """What a command of ours says, without a process for each."""
    with redirect_stdout(io.StringIO()) as told:
        code = main(list(command[command.index("rvmon") + 1 :]))
    return Cost(1, 1, 1, code, told.getvalue(), "")


@pytest.mark.slow
def test_all_ways_find_the_same_failures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each way has a line, with a ratio as its failures are the first's; who is absent is named."""
    monkeypatch.setattr(files, "SMALL", 3)
    monkeypatch.setattr(files, "EACH", 1_000)
    monkeypatch.setattr(files, "measured", in_this_process)
    absent = Environment(Path(sys.executable), {}, {"duckdb": "not on this index"})
    size = replace(QUICK, file_rows=20_000, columns=2_000, files=2, processes=1)
    lines = list(files.lines(size, absent))
    assert lines[-1] == "Not measured: DuckDB, 20,000 rows: not on this index."
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines[2:-2]]
    assert len(cells) == 16
    assert [ratio.endswith("×") for *_, ratio, _ in cells].count(True) == 8
    assert not any("others" in failures for *_, failures in cells)
    assert any(failures not in ("0", "–") for *_, failures in cells)
