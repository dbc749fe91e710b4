"""The directed tests, played and judged by the specification of their robot."""

from functools import cache
from itertools import pairwise

import pytest

import rvmon
from handover.checker import spec_path
from handover.collector.code import TRANSITIONS
from handover.driver import run_test
from handover.generator.abstract_test import AbstractTest, directed
from rvmon.cdv.system import Checker


def test_each_says_which_situation_it_is_to_reach() -> None:
    """In words of the coverage model, which the campaign looks for in its run."""
    assert [test.name for test in directed() if not test.reaches] == []


@cache
def spec_of(robot: str) -> rvmon.Spec:
    """The specification of a robot: of all its tests one."""
    return rvmon.load(spec_path(robot))


@pytest.mark.campaign
@pytest.mark.parametrize("test", directed(), ids=lambda test: test.name)
def test_verdicts_are_those_the_file_expects(test: AbstractTest) -> None:
    """Else nothing fails, and the robot goes from state to state as its protocol says."""
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
