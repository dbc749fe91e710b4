"""Each benchmark is a program that says what it does."""

import runpy
import sys
from pathlib import Path

import pytest
from benchmarks.timing import cliffs

FOLDER = Path(__file__).parents[2] / "benchmarks"
BENCHMARKS = [path.stem for path in FOLDER.glob("*.py") if "__main__" in path.read_text("utf-8")]


# Other tests of the same process have imported some of them.
@pytest.mark.filterwarnings("ignore:.*found in sys.modules:RuntimeWarning")
@pytest.mark.parametrize("name", BENCHMARKS)
def test_each_helps(
    name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["it", "--help"])
    monkeypatch.delitem(sys.modules, f"benchmarks.{name}", raising=False)
    with pytest.raises(SystemExit) as ended:
        runpy.run_module(f"benchmarks.{name}", run_name="__main__", alter_sys=True)
    assert ended.value.code == 0
    assert len(capsys.readouterr().out.splitlines()) > 3


@pytest.mark.slow
def test_hard_streams_have_neighbours() -> None:
    lines = list(cliffs.lines(60, 1))
    assert len(lines) == 2 + 15 + 3 + 13 + 15
    assert all(line.count("|") == 8 for line in lines[2:])
