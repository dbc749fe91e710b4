"""The robot's code, as what coverage is measured of: a block per state."""

from __future__ import annotations

from pathlib import Path

from handover.robot import behaviour, handover
from handover.robot.handover import STATES
from handover.robot.layout import COMMON, code_blocks
from rvmon.cdv import Block, Code

_BEFORE_THE_TEST = "__init__"
"""The one function that runs before any step of the robot can be measured."""


_EQUIVALENT = Path(__file__).with_name("equivalent.toml")


def robot_code() -> Code:
    """The blocks of the robot's functions, without their first lines: those run at import.

    >>> [block.name for block in robot_code().blocks][-2:]
    ['done', 'common']
    """
    blocks = [block for block in code_blocks() if block.function != _BEFORE_THE_TEST]
    lines: dict[str, set[int]] = {state: set() for state in (*STATES, COMMON)}
    for block in blocks:
        lines[block.state].update(range(block.first + 1, block.last + 1))
    path = blocks[0].path
    return Code(
        [Block(state, path, frozenset(own)) for state, own in lines.items()],
        marked=True,
        kind="state",
        constants={
            path: [name for name in vars(handover) if name.isupper()],
            str(behaviour.__file__): ["CORRECT"],
        },
        equivalent=_EQUIVALENT,
    )
