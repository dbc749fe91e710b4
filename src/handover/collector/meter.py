"""Measure with coverage.py which statements of the robot's code each test runs."""

from __future__ import annotations

from types import TracebackType

from coverage import Coverage

from handover.collector.statements import Statements
from handover.robot.handover import STATES
from handover.robot.layout import COMMON, code_blocks

_BEFORE_THE_TEST = "__init__"
"""The one function that runs before any step of the robot can be measured."""


class StatementMeter:
    """One measurement for many tests, one after the other, each with its own context.

    It is on only while the robot takes a step, so that the simulation around it pays nothing:
    give the meter itself as `around_robot_step=lambda: meter`.
    """

    def __init__(self) -> None:
        self._path = code_blocks()[0].path
        self._coverage = _coverage()
        self._tests = 0

    def begin(self) -> None:
        """From now on, what runs belongs to a new test."""
        self._tests += 1
        self._coverage.start()
        self._coverage.switch_context(str(self._tests))
        self._coverage.stop()

    def __enter__(self) -> None:
        self._coverage.start()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        place: TracebackType | None,
    ) -> None:
        self._coverage.stop()

    def executed(self) -> frozenset[int]:
        """The lines that this test ran."""
        data = self._coverage.get_data()
        data.set_query_context(str(self._tests))
        return frozenset(data.lines(self._path) or ())


def robot_statements() -> Statements:
    """The robot's statements by coverage.py's count, in functions only: the rest runs at import.

    >>> robot_statements().by_state["release"] != frozenset()
    True
    """
    blocks = [block for block in code_blocks() if block.function != _BEFORE_THE_TEST]
    path = blocks[0].path
    statements = _coverage().analysis2(path)[1]
    by_state: dict[str, set[int]] = {state: set() for state in (*STATES, COMMON)}
    for block in blocks:
        inside = (line for line in statements if block.first < line <= block.last)
        by_state[block.state].update(inside)
    return Statements(path, {state: frozenset(lines) for state, lines in by_state.items()})


def _coverage() -> Coverage:
    """A fresh measurement of the robot's file, kept in memory, whatever the user's settings."""
    meter = Coverage(data_file=None, config_file=False, include=[code_blocks()[0].path])
    meter.set_option("run:core", "ctrace")  # the newer core knows no contexts
    meter.set_option("run:disable_warnings", ["no-data-collected"])
    return meter
