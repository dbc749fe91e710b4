"""Executed statements of the robot's code, by state."""

import pytest

from handover.collector.code import COMMON, robot_code, state_of_functions
from handover.driver import run_test
from handover.generator.abstract_test import directed
from handover.robot.handover import STATES
from rvmon.cdv.code_coverage import Meter, code_groups, statements_name
from rvmon.coverage import score

TESTS = {test.name: test for test in directed()}
GROUPS = {group.name: group for group in code_groups(robot_code())}


@pytest.fixture(scope="module")
def measured():
    """The runs and hits of a handover with a release, and of one without a person."""
    meter = Meter(robot_code())
    runs, hits = {}, {}
    for name in ("released", "nobody-comes"):
        meter.start()
        runs[name] = run_test(TESTS[name], around_robot_step=lambda: meter)
        hits[name] = meter.hits()
    return runs, hits


def test_functions_belong_to_states():
    owners = state_of_functions()
    assert {state: owners[state] for state in STATES} == {state: state for state in STATES}
    assert owners["go_to"] == "move"
    assert owners["poll_signal"] == COMMON
    assert not any("__init__" in block.name for block in robot_code().blocks)


def test_every_state_has_statements():
    assert {statements_name(state) for state in STATES} < GROUPS.keys()
    assert all(group.items for group in GROUPS.values())
    lines = [line for group in GROUPS.values() for line in group.items]
    assert len(lines) == len(set(lines)) > 100


@pytest.mark.campaign
def test_a_release_executes_its_block_completely(measured):
    """The block of the paper's coverage hole: 100 % with a release, 0 % without a person."""
    _, hits = measured
    release = GROUPS[statements_name("release")]
    released, nobody = (score(hits[name], release) for name in ("released", "nobody-comes"))
    assert released.covered == released.items > 0
    assert nobody.covered == 0


@pytest.mark.campaign
def test_measuring_changes_nothing(measured):
    runs, _ = measured
    assert runs["released"] == run_test(TESTS["released"])
