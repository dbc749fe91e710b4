"""The robustness of attempts while samples come; the core finds it beside their verdicts.

What comes behind a decision counts as long as the window is open.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from threading import Lock
from typing import Any, ParamSpec, TypeVar

from rvmon.errors import OverlapError, TraceError, UnknownNameError
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.fed import FedMonitor
from rvmon.monitor.core.feed import Feed
from rvmon.monitor.core.planned import planned_core
from rvmon.monitor.inputs.intake import WAYS_TO_SETTLE
from rvmon.monitor.robustness.values import FIGURES, Measured
from rvmon.trace.time import ticks_of_seconds, whole_ticks

P = ParamSpec("P")
R = TypeVar("R")


class RobustnessMonitor(FedMonitor[Measured]):
    """Measures a stream of samples; made by `Spec.robustness_monitor`.

    What a call returns are the figures that nothing can change any more. A sample that is later
    than `max delay` is refused, and figures that were given stay whatever came too late.

    Args:
        compiled: the specification.
        only: ids of the requirements; default all.
        settle: `now` or `next`, as for a monitor.
        sources: the names that can arrive; `None`: all.
        streams: whether to measure each position, and not the attempts alone.

    Raises:
        UnknownNameError: there is no such way to settle.
    """

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
        self._planned = planned_core(compiled, only, measured=True)
        absent = frozenset() if sources is None else frozenset(self._planned.numbers) - sources
        self._core = self._planned.monitor(absent, self._take_at, self._take)
        self._feed = Feed(checked, self._planned, self._core, sources, settle)
        self._core.measure(FIGURES, streams)
        self._turn = Lock()
        self._is_over = False
        self._attend()

    def _attend(self) -> None:
        """Let the core take the next sample itself, unless there is more to do with it."""
        core: Any = self._core  # its steps give figures now
        if self._feed.is_direct:
            self.step, self.step_ns = core.step, core.step_ns
        else:
            self.step, self.step_ns = self._take_at, self._take

    def _take(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Measured]:
        """Take a sample that the core does not take itself."""
        return self._tell(self._step, t_ns, values)

    def _tell(
        self, tell: Callable[P, None], *args: P.args, **kwargs: P.kwargs
    ) -> Sequence[Measured]:
        """Make a call, and no other until it is over; the figures that it settled."""
        return self._one_call(self._settled, partial(tell, *args, **kwargs))

    def _settled(self, tell: Callable[[], None]) -> Sequence[Measured]:
        tell()
        self._attend()
        return self._core.figures()

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

    def _step(self, t_ns: int, values: Mapping[str, Any]) -> None:
        t_ns = self._taken_time(t_ns)
        self._feed.take(t_ns, self._feed.check(t_ns, values))

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
        self._feed.close()
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
