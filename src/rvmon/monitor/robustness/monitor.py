"""The robustness of attempts while samples come; the core finds it beside their verdicts.

What comes behind a decision counts as long as the window is open.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from threading import Lock
from typing import Any, ParamSpec, TypeVar

from rvmon.errors import OverlapError, TraceError, UnknownNameError
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.planned import planned_core
from rvmon.monitor.inputs.intake import WAYS_TO_SETTLE, Intake
from rvmon.monitor.inputs.order import refuse_earlier
from rvmon.monitor.inputs.validate import Validator
from rvmon.monitor.robustness.values import FIGURES, Measured
from rvmon.trace.sample import Value
from rvmon.trace.time import ticks_of_seconds, whole_ticks

P = ParamSpec("P")
R = TypeVar("R")


class RobustnessMonitor:
    """Measures a stream of samples; made by `Spec.robustness_monitor`.

    Times are as for `rvmon.monitor.Monitor`: seconds, or ticks in the methods that end in `_ns`; so
    are the errors.

    Args:
        compiled: the specification.
        only: ids of the requirements; default all.
        settle: `now` or `next`, as for a monitor.
        sources: the names that can arrive; `None`: all.
        streams: whether to measure each position, and not the attempts alone.

    Attributes:
        step: a function that takes one sample (seconds); see `step_ns`.
        step_ns: a function that takes one sample and returns the figures that nothing can change
            any more.

    Raises:
        UnknownNameError: there is no such way to settle.
    """

    step: Callable[[float, Mapping[str, Any]], Sequence[Measured]]
    step_ns: Callable[[int, Mapping[str, Any]], Sequence[Measured]]

    def __init__(
        self,
        compiled: CompiledSpec,
        only: Sequence[str] | None = None,
        settle: str = "now",
        sources: frozenset[str] | None = None,
        *,
        streams: bool = False,
    ) -> None:
        if settle not in WAYS_TO_SETTLE:
            ways = ", ".join(WAYS_TO_SETTLE)
            raise UnknownNameError(f"no way to settle `{settle}`: there are {ways}")
        checked = compiled.checked
        delay = checked.max_delay or 0
        holds_back = delay or settle == "next"
        self._intake = Intake(delay, checked.events) if holds_back else None
        self._planned = planned_core(compiled, only, measured=True)
        absent = frozenset() if sources is None else frozenset(self._planned.numbers) - sources
        self._validator = Validator(checked, sources, self._planned.single_payloads)
        self._core = self._planned.monitor(absent, self._take_at, self._look_closer)
        self._core.measure(FIGURES, streams)
        self._turn = Lock()
        self._is_over = False
        if holds_back:
            self.step, self.step_ns = self._take_at, self._look_closer
        else:
            core: Any = self._core  # its steps give figures now
            self.step, self.step_ns = core.step, core.step_ns

    def _take_at(self, t: float, values: Mapping[str, Any]) -> Sequence[Measured]:
        """Take a sample at seconds."""
        if type(values) is not dict and not isinstance(values, Mapping):
            raise TraceError(f"sample at {t} s: expected values by name, found {values!r}")
        return self.step_ns(ticks_of_seconds(t), values)

    def _look_closer(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Measured]:
        """Take a sample that is none of plain values in a `dict`."""
        return self._one_call(self._step, t_ns, values)

    def _one_call(self, call: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
        """Make a call, and no other until it is over.

        Raises:
            OverlapError: another one is under way.
        """
        if not self._turn.acquire(blocking=False):
            raise _overlap()
        try:
            if not self._core.hold(True):
                raise _overlap()
            try:
                return call(*args, **kwargs)
            finally:
                self._core.hold(False)
        finally:
            self._turn.release()

    def _step(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Measured]:
        t_ns = self._taken_time(t_ns)
        if self._intake is not None:
            self._settle(self._intake.take(t_ns, self._validator.check(t_ns, values)))
            self._core.advance(self._intake.floor)
        else:
            _, last, reached = self._core.times()
            refuse_earlier(t_ns, last, reached)
            self._judge(t_ns, self._validator.check(t_ns, values))
        return self._core.figures()

    def _settle(self, samples: Sequence[Any]) -> None:
        for sample in samples:
            self._judge(sample.t, sample.values)

    def _judge(self, t: int, values: Mapping[str, Value]) -> None:
        if not self._core.judge(t, self._planned.plain(t, values), True):
            raise ValueError("the core does not take a sample that was checked")

    def advance(self, t: float) -> Sequence[Measured]:
        """Say that no sample before `t` (seconds) will come; see `advance_ns`."""
        return self.advance_ns(ticks_of_seconds(t))

    def advance_ns(self, t_ns: int) -> Sequence[Measured]:
        """Say that no sample before `t_ns` will come; returns the figures that this settled."""
        return self._one_call(self._advance, t_ns)

    def _advance(self, t_ns: int) -> Sequence[Measured]:
        t_ns = self._taken_time(t_ns)
        if self._intake is not None:
            self._settle(self._intake.settle(t_ns))
        self._core.advance(t_ns)
        return self._core.figures()

    @property
    def open(self) -> Sequence[Measured]:
        """What is known now of the attempts that are not settled: bounds that only draw closer."""
        return self._one_call(self._core.open_figures)

    def finish(self, t: float | None = None) -> Sequence[Measured]:
        """End the run, at `t` seconds if that is later than all so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Sequence[Measured]:
        """End the run, at `t_ns` if that is later than all so far, and return the other figures."""
        return self._one_call(self._finish, t_ns)

    def _finish(self, t_ns: int | None) -> Sequence[Measured]:
        if self._is_over:
            return ()
        if t_ns is not None:
            t_ns = whole_ticks(t_ns)
        if self._intake is not None:
            self._settle(self._intake.close())
        self._core.finish(t_ns)
        self._is_over = True
        return self._core.figures()

    def _taken_time(self, t: int) -> int:
        """A time that was given, as a plain integer."""
        if self._is_over:
            raise TraceError("the run is finished: make a monitor for the next")
        return whole_ticks(t)


def _overlap() -> OverlapError:
    return OverlapError(
        "another call of this monitor is under way, in another thread or in what a signal handler "
        "has interrupted; this one was not taken: give each thread a monitor of its own "
        "(spec.robustness_monitor()), or hold a lock round the calls"
    )
