"""Calls of a monitor, one at a time, and who is called with what they decide."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import ParamSpec, TypeVar

from rvmon import native
from rvmon.errors import OverlapError, RvmonError
from rvmon.trace.sample import Health, HealthKind
from rvmon.trace.time import TIME_LIMIT
from rvmon.verdict import Verdict, fold
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report

Callback = Callable[[Attempt], object]


class Listeners:
    """The callbacks of a monitor, in the order in which they were registered."""

    def __init__(self) -> None:
        self._callbacks: dict[object, tuple[bool, Callback]] = {}

    def __bool__(self) -> bool:
        return bool(self._callbacks)

    def add(
        self, callback: Callback, changed: Callable[[], None], *, failures_only: bool
    ) -> Callable[[], None]:
        """Register a callback.

        Returns:
            A function without arguments that ends this; to call it again does nothing.

        Raises:
            RvmonError: it cannot be called.
        """
        if not callable(callback):
            raise RvmonError(f"expected a function that takes an attempt, found {callback!r}")
        key = object()
        self._callbacks[key] = (failures_only, callback)
        changed()

        def stop() -> None:
            self._callbacks.pop(key, None)
            changed()

        return stop

    def call(self, decided: Sequence[Attempt]) -> None:
        """Call the callbacks, which may call the monitor: the call that decided is over.

        Raises:
            Exception: what a callback raised, when all were called; several as a group.
        """
        if not self._callbacks:
            return
        errors: list[Exception] = []
        for attempt in decided:
            for failures_only, callback in tuple(self._callbacks.values()):
                asked = attempt.verdict is Verdict.FAIL or not failures_only
                if attempt.decided is None or not asked:
                    continue
                try:
                    callback(attempt)
                except Exception as error:  # noqa: BLE001 - the others are called first
                    errors.append(error)
        if len(errors) > 1:
            raise ExceptionGroup("several callbacks of a monitor failed", errors)
        if errors:
            raise errors[0]


BEFORE_ALL = 1 - TIME_LIMIT
"""The instant of a call that was interrupted before any sample was taken."""


def not_passed(verdicts: Mapping[str, Verdict]) -> Mapping[str, Verdict]:
    """Verdicts of which those that are not `F` are `I`."""
    return {name: fold([verdict], complete=False) for name, verdict in verdicts.items()}


def capped(report: Report, interrupted: int) -> Report:
    """A report without verdicts that are not known, and why.

    Args:
        report: of the run.
        interrupted: how far it had come when a call was interrupted, ticks.
    """
    first = None if interrupted == BEFORE_ALL else interrupted
    remark = "what followed was not evaluated in full"
    why = Health(HealthKind.INTERRUPTED, "monitor", 1, first, tuple(report.verdicts), remark)
    return replace(report, verdicts=not_passed(report.verdicts), health=(why, *report.health))


P = ParamSpec("P")
R = TypeVar("R")


class OneCall:
    """Refuses a call that comes while another is under way, from whatever thread.

    Args:
        core: the run that calls are made on; it takes no samples by itself meanwhile.

    Attributes:
        began: the instant of the first sample, when the last call came; `None`: there was none.
        reached: how far the run had come then, ticks.
        interrupted: how far it had come when a call was interrupted or failed; `None`: none was.
    """

    def __init__(self, core: native.Monitor) -> None:
        self._core = core
        self._turn: dict[None, object] = {}
        self._spared: BaseException | None = None
        self.interrupted: int | None = None
        self.note_times()

    def note_times(self) -> None:
        """Note how far the run has come."""
        self.began, _, self.reached = self._core.times()

    def __call__(self, call: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
        """Make a call, and no other until it is over.

        Raises:
            OverlapError: another one is under way.
        """
        # An interrupt strikes where a call begins or ends. So that none can come between taking the
        # turn and seeing that it is given back, one call takes it within the `try`, and none is
        # needed to know whose it is, or to give it back.
        own = object()
        try:
            if self._turn.setdefault(None, own) is not own or not self._core.hold(True):
                raise overlap()
            try:
                self.note_times()
                return call(*args, **kwargs)
            finally:
                self._core.hold(False)
        except RvmonError:
            raise
        except BaseException as error:
            # No function is called up to the mark: another interrupt cannot come before it.
            if self.interrupted is None and error is not self._spared:
                self.interrupted = BEFORE_ALL if self.reached is None else self.reached
            raise
        finally:
            self._spared = None
            # Threads that run at once may give it back between a look whether it is there and
            # another whose it is.
            try:
                if self._turn[None] is own:
                    del self._turn[None]
            except KeyError:
                pass

    def spare(self, call: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
        """Make a part of the call under way that changes nothing, whatever it raises."""
        try:
            return call(*args, **kwargs)
        except BaseException as error:
            self._spared = error
            raise


def overlap() -> OverlapError:
    """The error of a call that comes while another is under way."""
    return OverlapError(
        "another call of this monitor is under way, in another thread or in what a signal handler "
        "has interrupted; this one was not taken: give each thread a monitor of its own, or hold "
        "a lock round the calls"
    )
