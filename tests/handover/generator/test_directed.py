"""The directed tests, judged by the specification of their robot."""

from functools import cache
from itertools import pairwise

import pytest

import rvmon
from handover.checker import spec_path
from handover.collector.code import TRANSITIONS
from handover.driver import run_test
from handover.generator.abstract_test import AbstractTest, directed
from rvmon.cdv.system import Checker


def test_each_names_the_situation_that_it_reaches() -> None:
    """In terms of the coverage model; the campaign checks that its run hits it."""
    assert [test.name for test in directed() if not test.reaches] == []


@cache
def spec_of(robot: str) -> rvmon.Spec:
    """The specification of a robot, shared by all its tests."""
    return rvmon.load(spec_path(robot))


@pytest.mark.campaign
@pytest.mark.parametrize("test", directed(), ids=lambda test: test.name)
def test_verdicts_are_those_the_file_expects(test: AbstractTest) -> None:
    """No other requirement fails, and the robot's states follow its protocol."""
    assert test.robot is not None
    checker = Checker(spec_of(test.robot))
    checker.start()
    run = run_test(test, observer=checker.observe)
    report = checker.finish(run.end_ns)
    verdicts = {name: str(verdict) for name, verdict in report.verdicts.items()}
    assert {name: verdicts[name] for name in test.expected} == test.expected
    others = {name for name, verdict in verdicts.items() if verdict == "F"} - test.expected.keys()
    assert test.mutation is not None or others == set()
    assert (run.error is not None) == (test.mutation == "crashes")
    transitions = set(pairwise(state for _, state in run.states))
    assert test.mutation is not None or transitions <= set(TRANSITIONS)
