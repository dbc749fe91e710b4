"""Which lines of the robot's code belong to which of its states, read off the code itself."""

from __future__ import annotations

import inspect
from types import FunctionType

from handover.robot.code_block import CodeBlock
from handover.robot.handover import STATES, HandoverRobot

COMMON = "common"
"""The group of the code that several states share, or none."""


def code_blocks() -> tuple[CodeBlock, ...]:
    """All functions of the state machine, grouped by state, in the order of the file.

    A state's method belongs to it; a helper belongs to the one state that calls it, directly or
    through other helpers, and to `COMMON` if several do.

    >>> sorted({block.state for block in code_blocks()} - {COMMON}) == sorted(STATES)
    True
    """
    functions = {
        name: member for name, member in vars(HandoverRobot).items() if inspect.isfunction(member)
    }
    users: dict[str, set[str]] = {name: set() for name in functions}
    for state in STATES:
        for name in _reachable(state, functions):
            users[name].add(state)
    return tuple(
        _block(function, next(iter(users[name])) if len(users[name]) == 1 else COMMON)
        for name, function in functions.items()
    )


def _reachable(name: str, functions: dict[str, FunctionType]) -> set[str]:
    found = {name}
    todo = [name]
    while todo:
        for called in functions[todo.pop()].__code__.co_names:
            if called in functions and called not in found:
                found.add(called)
                todo.append(called)
    return found


def _block(function: FunctionType, state: str) -> CodeBlock:
    lines, first = inspect.getsourcelines(function)
    path = inspect.getsourcefile(function)
    assert path is not None  # noqa: S101  # the class is defined in a file
    return CodeBlock(state, function.__name__, path, first, first + len(lines) - 1)
