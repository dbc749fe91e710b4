"""Programs that wait, end, crash or hang."""

from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import partial
from typing import Any

from tests.tools.each import each

from handover.world.bus import Bus, Node, Schedule
from handover.world.parameters import NS
from handover.world.process import Process, Program


def play(program: Program) -> tuple[Process, Schedule]:
    schedule = Schedule()
    process = Process(schedule, Node(Bus(schedule), {}, 0.0), program)
    while schedule.next_ns() is not None:
        schedule.run_next()
    return process, schedule


def test_waits_are_exact() -> None:
    def program() -> Program:
        for _ in range(10):
            yield 0.1

    process, schedule = play(program())
    assert process.error is None
    assert schedule.now_ns == NS


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
    process, _ = play(program())
    assert process.error is not None
    assert error in process.error


def test_context_surrounds_each_step_only() -> None:
    entered: list[str] = []

    @contextmanager
    def around() -> Generator[None, None, None]:
        entered.append("in")
        yield
        entered.append("out")

    def program() -> Program:
        entered.append("step")
        yield 1.0
        entered.append("step")
        yield 1.0

    schedule = Schedule()
    Process(schedule, Node(Bus(schedule), {}, 0.0), program(), around)
    while schedule.next_ns() is not None:
        schedule.run_next()
    assert entered == ["in", "step", "out"] * 2 + ["in", "out"]
