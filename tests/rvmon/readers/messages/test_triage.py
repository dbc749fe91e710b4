"""The example that sorts bags, and the page that shows how to judge one."""

import re
import runpy
import shlex
import shutil
import sys
from pathlib import Path

import pytest
from tests.tools.bags import drive, write_ros1, write_ros2

from rvmon.cli import main

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

ROOT = Path(__file__).parents[4]
PAGE = (ROOT / "docs" / "how-to" / "judge-a-ros-bag.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_example_sorts_bags_by_what_needs_a_look(tmp_path, monkeypatch, capsys):
    """Failures first, then what cannot be read; the exit code says whether there is any."""
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
    assert "B2 #1 FAIL" in lines[0]
    assert ended.value.code == 1


@pytest.mark.slow
def test_the_commands_of_the_page_do_what_it_says(tmp_path, monkeypatch, capsys):
    """Each prints what stands below it."""
    monkeypatch.chdir(tmp_path)
    for name in ("base.rv", "base.toml"):
        shutil.copy(ROOT / "examples" / name, tmp_path)
    write_ros2(tmp_path / "monday", drive(stops_in_s=0.4), "mcap")
    (tmp_path / "runs").mkdir()
    write_ros2(tmp_path / "runs" / "tuesday", drive(stops_in_s=0.6), "sqlite3")
    for text in re.findall(r"```console\n\$ (.*?)```", PAGE, re.DOTALL):
        command, _, output = text.partition("\n")
        words, sign, file = command.partition(" > ")
        main(shlex.split(words)[1:])
        told = capsys.readouterr()
        if sign:
            Path(file).write_text(told.out, encoding="utf-8")
            continue
        lines = [line.rstrip() for line in (told.err + told.out).rstrip().splitlines()]
        assert lines == output.rstrip().splitlines(), command


def test_the_binding_of_the_page_is_the_example(tmp_path):
    """As it is after it was looked over."""
    [text] = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    assert text == (ROOT / "examples" / "base.toml").read_text(encoding="utf-8").partition("\n")[2]
