"""The node of ROS 2 in C++, against a stand-in for rclcpp, which cannot be installed here."""

import csv
import re
import subprocess
from pathlib import Path

import pytest

from rvmon import load
from rvmon.cli import main

EXAMPLES = Path(__file__).parents[2] / "examples"


def _run(*command, told=""):
    """What a command prints."""
    return subprocess.run(  # noqa: S603
        command, input=told, check=True, stdout=subprocess.PIPE, text=True
    ).stdout


@pytest.mark.process
def test_the_node_says_what_rvmon_says(gcc, tmp_path):
    """On each verdict of the recording; deadlines pass by the timer."""
    node = EXAMPLES / "ros2_node" / "node.cpp"
    main(["export", str(EXAMPLES / "base.rv"), "--to", "c", "-o", str(tmp_path)])
    for name in re.findall(r"<(\w+/.+)>", node.read_text()):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text('#include "rclcpp_stub.hpp"\n')
    flags = ["-Wall", "-Wextra", "-Werror", f"-I{tmp_path}", f"-I{Path(__file__).parent}"]
    objects = []
    for name in ("rvmon_core", "base_plan"):
        objects.append(tmp_path / f"{name}.o")
        _run(gcc, "-c", tmp_path / f"{name}.c", "-o", objects[-1])
    _run("g++", "-std=c++17", *flags, node, *objects, "-o", tmp_path / "node")
    lines = []
    with (EXAMPLES / "base.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            t = round(float(row["t"]) * 1e9)
            lines += [f"{t} time 0", f"{t} odom -{row['speed']}", f"{t} range {row['obstacle']}"]
            lines += [f"{t} stop {row['stop_request'] or 0}"]
    told = _run(tmp_path / "node", told="\n".join(lines)).splitlines()
    attempts = load(EXAMPLES / "base.rv").evaluate(EXAMPLES / "base.csv").attempts
    assert sorted(told) == sorted(f"{one.name} {one.verdict}" for one in attempts)
