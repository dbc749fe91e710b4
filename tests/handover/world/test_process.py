"""Programs that crash, hang or wait for what is no time."""

from collections.abc import Callable
from functools import partial
from typing import Any

from tests.tools.each import each

from handover.world.bus import Bus, Node, Schedule
from handover.world.process import Process, Program


def play(program: Program) -> Process:
    schedule = Schedule()
    process = Process(schedule, Node(Bus(schedule), {}, 0.0), program)
    while schedule.next_ns() is not None:
        schedule.run_next()
    return process


def crashing() -> Program:
    yield 1.0
    raise KeyError("gripper")


def hanging() -> Program:
    while True:
        yield 0.0


def waiting(wait: object) -> Any:
    yield wait


@each(
    ("program", "error"),
    [
        (crashing, "KeyError: 'gripper' (test_process.py, line "),
        (hanging, "hangs"),
        # Whatever is no number of seconds is the program's error.
        *(
            (partial(waiting, wait), "yielding seconds")
            for wait in (-1.0, float("nan"), float("inf"), "2", None, True)
        ),
    ],
)
def test_how_a_program_failed_is_a_result(program: Callable[[], Program], error: str) -> None:
    found = play(program()).error
    assert found is not None
    assert error in found
