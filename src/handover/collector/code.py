"""The robot's code whose coverage is measured: a block of statements per state."""

from __future__ import annotations

import inspect
from pathlib import Path

from handover.robot import behaviour, handover
from handover.robot.handover import STATES, HandoverRobot
from rvmon.cdv import Block, Code, blocks_of

COMMON = "common"
"""The block of the code that belongs to several states, or to none."""

TRANSITIONS = (
    ("reset", "receive_activation"),
    ("receive_activation", "receive_activation"),
    ("receive_activation", "move"),
    ("receive_activation", "done"),
    ("move", "send_signal"),
    ("move", "done"),
    ("send_signal", "receive_readiness"),
    ("receive_readiness", "receive_readiness"),
    ("receive_readiness", "sense"),
    ("receive_readiness", "done"),
    ("sense", "sense"),
    ("sense", "decide"),
    ("sense", "done"),
    ("decide", "release"),
    ("decide", "done"),
    ("release", "done"),
)
"""The transitions of the code, loops and failures included, in the order of a handover."""

_EQUIVALENT = Path(__file__).with_name("equivalent.toml")


def robot_code() -> Code:
    """The robot's code as blocks, without the `def` lines, which run at import.

    >>> [block.name for block in robot_code().blocks][-2:]
    ['done', 'common']
    """
    path = str(handover.__file__)
    owners = state_of_functions()
    names = {f"{HandoverRobot.__name__}.{name}": owners[name] for name in (*STATES, *owners)}
    # `__init__` runs before the first measured step of the robot, so it is left out.
    first = f"{HandoverRobot.__name__}.__init__"
    (before,) = (block for block in blocks_of(path) if block.name == first)
    blocks = {block.name: block.lines - before.lines for block in blocks_of(path, names)}
    return Code(
        [Block(name, path, blocks[name]) for name in (*STATES, COMMON)],
        marked=True,
        kind="state",
        constants={
            path: [name for name in vars(handover) if name.isupper()],
            str(behaviour.__file__): ["CORRECT"],
        },
        equivalent=_EQUIVALENT,
    )


def state_of_functions() -> dict[str, str]:
    """The state of each function of the state machine, in the order of the file.

    The method of a state belongs to the state. A helper belongs to the only state that calls it,
    directly or through other helpers, or to `COMMON` if several states do.

    >>> state_of_functions()["go_to"], state_of_functions()["poll_signal"]
    ('move', 'common')
    """
    functions = {
        name: member.__code__.co_names
        for name, member in vars(HandoverRobot).items()
        if inspect.isfunction(member)
    }
    users: dict[str, set[str]] = {name: set() for name in functions}
    for state in STATES:
        todo = [state]
        while todo:
            name = todo.pop()
            if state not in users[name]:
                users[name].add(state)
                todo += [called for called in functions[name] if called in functions]
    return {name: own.pop() if len(own) == 1 else COMMON for name, own in users.items()}
