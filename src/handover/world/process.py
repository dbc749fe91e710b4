"""Run programs, which are generators that wait by yielding seconds, by the schedule."""

from __future__ import annotations

import math
import traceback
from collections.abc import Callable, Generator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path

from handover.world.bus import Node, Schedule
from handover.world.parameters import NS

Program = Generator[float, None, None]

STALL_LIMIT = 10_000
"""The number of steps at one instant after which a program is considered to hang."""

_ENDED = object()


@dataclass(slots=True)
class Process:
    """Runs a program on a node, from now until it returns, crashes or time is over."""

    schedule: Schedule
    node: Node
    program: Program
    around: Callable[[], AbstractContextManager[object]] = nullcontext  # context of each step
    is_over: bool = field(default=False, init=False)  # whether it returned or crashed
    error: str | None = field(default=None, init=False)  # its exception, in the form of `describe`
    _steps_now: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self.schedule.at(self.schedule.now_ns, self._step)

    def _step(self) -> None:
        try:
            with self.around():
                wait_s = next(self.program, _ENDED)
            if wait_s is _ENDED:
                self._end()
                return
            wait_ns = self._checked_ns(wait_s)
        except Exception as error:  # noqa: BLE001  # any exception of the code under test
            self.error = describe(error)
            self.program.close()
            self._end()
            return
        self.schedule.at(self.schedule.now_ns + wait_ns, self._step)

    def _end(self) -> None:
        self.is_over = True
        self.node.end()

    def _checked_ns(self, wait_s: object) -> int:
        if (
            not isinstance(wait_s, int | float)
            or isinstance(wait_s, bool)
            or not math.isfinite(wait_s)
            or wait_s < 0
        ):
            raise ValueError(f"a program waits by yielding seconds ≥ 0, not {wait_s!r}")
        wait_ns = round((wait_s + self.node.take_delay_s()) * NS)
        self._steps_now = 0 if wait_ns else self._steps_now + 1
        if self._steps_now > STALL_LIMIT:
            raise RuntimeError(f"no time passed in {STALL_LIMIT} steps: the program hangs")
        return wait_ns


def describe(error: Exception) -> str:
    """An exception as one line: its type, its text, and the innermost line of code."""
    frames = traceback.extract_tb(error.__traceback__)
    place = ""
    if frames:
        last = frames[-1]
        place = f" ({Path(last.filename).name}, line {last.lineno}, in {last.name})"
    return f"{type(error).__name__}: {error}{place}"
