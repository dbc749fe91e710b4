"""Programs that wait, end, crash or hang."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

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


def test_crash_is_a_result() -> None:
    def program() -> Program:
        yield 1.0
        raise KeyError("gripper")

    process, _ = play(program())
    assert process.error is not None
    assert process.error.startswith("KeyError: 'gripper' (test_process.py, line ")


@each("wait", [-1.0, float("nan"), float("inf"), "2", None, True])
def test_wrong_waits_are_errors(wait: object) -> None:
    """Whatever is no number of seconds is the program's error."""

    def program() -> Generator[object, None, None]:
        yield wait

    process, _ = play(program())  # type: ignore[arg-type]
    assert process.error is not None
    assert "yielding seconds" in process.error


def test_program_that_passes_no_time_is_ended() -> None:
    def program() -> Program:
        while True:
            yield 0.0

    process, _ = play(program())
    assert process.error is not None
    assert "hangs" in process.error


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
