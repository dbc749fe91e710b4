"""Which statements of the robot's code ran, by state."""

from itertools import pairwise

import pytest

from handover.collector.meter import StatementMeter, robot_statements
from handover.collector.statements import coverage_by_state, total_coverage
from handover.collector.transitions import TRANSITIONS
from handover.driver import run_test
from handover.generator.files import directed
from handover.robot.handover import STATES

TESTS = {test.name: test for test in directed()}


@pytest.fixture(scope="module")
def measured():
    """A handover that ends in a release, and one in which nobody comes: runs and lines."""
    meter = StatementMeter()
    runs, executed = {}, {}
    for name in ("released", "nobody-comes"):
        meter.begin()
        runs[name] = run_test(TESTS[name], around_robot_step=lambda: meter)
        executed[name] = meter.executed()
    return runs, executed


def test_every_state_has_statements():
    """The robot's code is divided among its states, each line in one of them."""
    by_state = robot_statements().by_state
    assert set(STATES) < set(by_state)
    assert all(by_state[state] for state in STATES)
    lines = [line for lines in by_state.values() for line in lines]
    assert len(lines) == len(set(lines)) > 100


@pytest.mark.campaign
def test_a_release_runs_the_whole_release_and_nobody_none_of_it(measured):
    """The block of the paper's coverage hole: 100 % by one test, 0 % by another."""
    _, executed = measured
    released = coverage_by_state(robot_statements(), executed["released"])
    nobody = coverage_by_state(robot_statements(), executed["nobody-comes"])
    assert released["release"].percent == 100
    assert released["release"].missing == ()
    assert nobody["release"].percent == 0
    assert len(nobody["release"].missing) == nobody["release"].statements


def test_tests_are_kept_apart(measured):
    """What one test ran is not counted for another; together they cover more than each."""
    _, executed = measured
    statements = robot_statements()
    alone = [total_coverage(statements, lines).covered for lines in executed.values()]
    both = total_coverage(statements, frozenset().union(*executed.values()))
    assert both.covered > max(alone)
    assert 0 < both.percent < 100


def test_measuring_changes_nothing(measured):
    """The run is the same as without measuring."""
    runs, _ = measured
    assert runs["released"] == run_test(TESTS["released"])


@pytest.mark.campaign
def test_all_transitions_that_happen_are_known(measured):
    """The chart has a line for every transition that a robot took."""
    seen = set()
    for test in TESTS.values():
        if test.mutation is None:
            states = [state for _, state in run_test(test).states]
            seen |= set(pairwise(states))
    assert seen <= set(TRANSITIONS)
