"""Mutants of the robot's code, under its own tests."""

import json

import pytest

from handover.cli import main
from handover.collector.code import robot_code
from handover.generator.abstract_test import directed
from handover.robot.handover import STATES
from rvmon.cdv.mutation.python_mutants import code_mutants
from rvmon.cdv.test import save

pytestmark = pytest.mark.campaign


def test_there_are_mutants_of_all_states_and_numbers():
    functions = {one.function for one in code_mutants(robot_code())}
    assert {f"HandoverRobot.{state}" for state in STATES} < functions
    assert {"HandoverRobot.poll_signal", "CORRECT", "PIECE_TOLERANCE"} < functions
    assert "LEGACY" not in functions


def test_a_robot_that_does_not_report_its_release_is_killed(tmp_path, capsys):
    """R1 fails; T70 fails for a robot that reports it twice at one instant."""
    tests = tmp_path / "tests"
    tests.mkdir()
    save(next(one for one in directed() if one.name == "released"), tests)
    command = ["mutate", "--tests", str(tests), "--of", "code", "--jobs", "1", "--held-out"]
    only = ["--only", "release:d", "--format", "json"]
    assert main([*command, *only]) == 0
    found = json.loads(capsys.readouterr().out)["suites"]["tests"]["mutants"]
    by_name = {one["mutant"]: one for one in found}
    dropped = by_name["handover:HandoverRobot.release:dropped-statement:4"]
    assert "R1" in dropped["killed_by"][0]["what"]
    doubled = by_name["handover:HandoverRobot.release:doubled-statement:4"]
    assert doubled["killed_by"][0]["what"] == ["T70"]
