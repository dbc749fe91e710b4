"""The examples print what their table says; those of ROS run with their adapters."""

import csv
import os
import re
import runpy
import subprocess
import sys
import time
import unittest
from pathlib import Path
from types import ModuleType

import pytest
from tests import WITHOUT
from tests.rvmon.adapters import rclpy_stub
from tests.tools.servers import Broker, missing, mosquitto

from rvmon import load
from rvmon.cli import main

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def play(monkeypatch, capsys):
    """Runs an example as a program, and gives the lines that it prints."""

    def play(path, *words):
        monkeypatch.setattr(sys, "argv", [path, *map(str, words)])
        runpy.run_path(str(EXAMPLES / path), run_name="__main__")
        return capsys.readouterr().out.splitlines()

    return play


def test_a_stream_in_another_program(play):
    lines = play("base_live.py")
    assert [line.split(" at ")[0] for line in lines if "#" in line] == [
        "B1#1 F",
        "B2#1 P",
        "B2#2 F",
    ]
    assert lines[-2:] == ["B1 F", "B2 F"]


@pytest.mark.slow
def test_a_loop_of_asyncio(play):
    (line,) = play("asyncio_loop/drive.py")
    assert line.startswith("B2#1 F `for 1 s speed <= 0.001 m/s` had to come true")


@pytest.mark.slow
@pytest.mark.parametrize(("wind", "verdicts"), [(3, "P NT NT"), (5, "F F F")])
def test_a_fence_of_a_drone(play, wind, verdicts):
    """It is left where the wind is stronger than the drone, and by how much is told."""
    *_, one, two, three, margin = play("geofence/fly.py", wind)
    assert [one, two, three] == [
        f"G{number} {verdict}" for number, verdict in enumerate(verdicts.split(), 1)
    ]
    assert margin.startswith("to the fence: -") == ("F" in verdicts)


@pytest.mark.campaign
def test_an_agent_that_learns(play, tmp_path):
    """It finds a hand in the gripper; what it found is a test that fails again."""
    from handover.driver import run_test
    from handover.generator.abstract_test import AbstractTest
    from rvmon import cdv

    pytest.importorskip("gymnasium")
    lines = play("learning/search.py", tmp_path / "found.json")
    rewards = [float(line.split("reward ")[1].split(",")[0]) for line in lines]
    assert rewards == sorted(rewards)
    assert lines[-1].endswith("R5 F")
    run = run_test(cdv.test.load(tmp_path / "found.json", AbstractTest))
    spec = load(EXAMPLES / "learning" / "grip.rv")
    declared = {*spec.schema.signals, *spec.schema.events}
    samples = [
        (t / 1e9, {n: v for n, v in values.items() if n in declared}) for t, values in run.samples
    ]
    assert spec.evaluate(samples).verdicts == {"R5": "F"}


@pytest.mark.process
def test_tests_of_a_base():
    """Five tests pass: three that simulate, and two requirements on a recording."""
    told = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist"],
        cwd=EXAMPLES / "pytest_plugin",
        env={**os.environ, "PYTEST_ADDOPTS": WITHOUT},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert told.returncode == 0, told.stdout
    assert "S1      3      1" in told.stdout


@pytest.mark.process
def test_a_fleet_over_mqtt(play, tmp_path):
    pytest.importorskip("paho.mqtt.client")
    from rvmon.adapters.json_objects import JsonObjects
    from rvmon.adapters.mqtt import MqttSource, address_of
    from rvmon.live import Live

    if mosquitto() is None:
        missing("mosquitto")
    broker = Broker(tmp_path)
    spec = load(EXAMPLES / "base.rv")
    address = address_of(f"mqtt://localhost:{broker.port}/robots/+/#")
    with Live(spec) as live:
        with MqttSource(JsonObjects(live), address):
            play("mqtt/fleet.py", broker.port)
            end = time.monotonic() + 20  # seconds that a busy machine may take
            while not live.status()["right"].counts and time.monotonic() < end:
                time.sleep(0.02)
        counts = {name: dict(status.counts) for name, status in live.status().items()}
    broker.stop()
    assert counts == {"left": {("B1", "F"): 1, ("B2", "F"): 1}, "right": {("B2", "P"): 1}}


def test_a_microcontroller(cortex_m):
    """The exported C on a Cortex-M4 under QEMU says what rvmon says; it compares them itself.

    It is not optimised here, which takes longest.
    """
    program = runpy.run_path(str(EXAMPLES / "microcontroller" / "run.py"))["main"]
    names = program.__globals__
    names["FLAGS"] = names["FLAGS"].replace("-Os", "-O0")
    with pytest.raises(SystemExit) as ended:
        program(*names["DEFAULT"])
    assert not ended.value.code


def test_a_test_of_launch_testing(monkeypatch, request):
    """It fails where the base does, or is not heard; with stand-ins: ROS cannot be installed."""
    request.config.addinivalue_line("markers", "launch_test: as launch_testing has it")
    graph = rclpy_stub.install(monkeypatch)
    graph.types = {"std_msgs/msg/Float64": rclpy_stub.message(data="double")}
    for name in ("launch", "launch_ros.actions", "launch_testing.actions"):
        package, _, part = name.partition(".")
        monkeypatch.setitem(sys.modules, package, ModuleType(package))
        if part:
            monkeypatch.setitem(sys.modules, name, ModuleType(name))
    told = {}
    for metres in (None, 0.8, 0.4):
        monkeypatch.setattr(time, "sleep", lambda _, metres=metres: _drive(graph, metres))
        test = runpy.run_path(str(EXAMPLES / "launch_testing" / "test_base.py"))["TestBase"]
        result = unittest.TestResult()
        test("test_requirements").run(result)
        told[metres] = [text for _, text in result.failures]
        assert not result.errors
    assert "nothing was heard" in told[None][0]
    assert told[0.8] == []
    assert "B1#1 F" in told[0.4][0]


def _drive(graph, metres):
    """A base that comes so near to an obstacle, if it is there at all."""
    for topic, value in (("/speed", 0.8), ("/obstacle", metres)):
        graph.publishers[topic] = ("std_msgs/msg/Float64", [rclpy_stub.QoSProfile()])
        if metres is not None:
            graph.call(graph.timers[-1])
            graph.publish(topic, data=value)


def _run(*command, told=""):
    """What a command prints."""
    return subprocess.run(  # noqa: S603
        command, input=told, check=True, stdout=subprocess.PIPE, text=True
    ).stdout


@pytest.mark.process
def test_the_node_says_what_rvmon_says(gcc, tmp_path):
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
