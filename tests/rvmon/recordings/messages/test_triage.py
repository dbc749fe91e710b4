"""The example that sorts bags."""

import runpy
import sys
from pathlib import Path

import pytest
from tests.tools.bags import drive, write_ros1, write_ros2

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

ROOT = Path(__file__).parents[4]


@pytest.mark.slow
def test_the_example_sorts_bags_by_what_needs_a_look(tmp_path, monkeypatch, capsys):
    write_ros1(tmp_path / "good.bag", drive(stops_in_s=0.4))
    (tmp_path / "late").mkdir()
    write_ros2(tmp_path / "late" / "monday", drive(stops_in_s=0.6), "mcap")
    write_ros1(tmp_path / "short.bag", drive(stops_in_s=0.4)[:390])
    (tmp_path / "torn.bag").write_bytes((tmp_path / "good.bag").read_bytes()[:5000])
    monkeypatch.setattr(sys, "argv", ["bag_triage.py", str(tmp_path)])
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(ROOT / "examples" / "bag_triage.py"), run_name="__main__")
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in lines] == [
        "F   late/monday",
        "?   torn.bag",
        "I   short.bag",
        "P   good.bag",
    ]
    assert "B2#1 F" in lines[0]
    assert ended.value.code == 1
