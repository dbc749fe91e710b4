"""Mutual exclusion of calls of a monitor, and callbacks for the attempts that calls decide."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import ParamSpec, TypeVar

from rvmon import native
from rvmon.errors import OverlapError, RvmonError
from rvmon.trace.sample import Health, HealthKind
from rvmon.trace.time import TIME_LIMIT
from rvmon.verdicts import Verdict, fold
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

Callback = Callable[[Attempt], object]


def checked(callback: object, takes: str) -> None:
    """Refuse an unusable callback; `takes` names its argument, such as "an attempt".

    Raises:
        RvmonError: it is not callable, or a coroutine function, whose call alone runs nothing.
    """
    if not callable(callback):
        raise RvmonError(f"expected a function that takes {takes}, found {callback!r}")
    if inspect.iscoroutinefunction(callback):
        raise RvmonError(
            f"expected a function that takes {takes}, found the coroutine function {callback!r}: "
            "nobody would await it. Give a plain function, which may start a task"
        )


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

        `changed` is called whenever a callback is added or removed.

        Returns:
            A function without arguments that unregisters it; idempotent.

        Raises:
            RvmonError: `callback` is not callable, or a coroutine function.
        """
        checked(callback, "an attempt")
        key = object()
        self._callbacks[key] = (failures_only, callback)
        changed()

        def stop() -> None:
            self._callbacks.pop(key, None)
            changed()

        return stop

    def call(self, decided: Sequence[Attempt]) -> None:
        """Call the callbacks; they may call the monitor, as the deciding call has ended.

        Raises:
            Exception: what a callback raised, after all have been called; several as a group.
        """
        if not self._callbacks:
            return
        errors: list[Exception] = []
        for attempt in decided:
            for failures_only, callback in tuple(self._callbacks.values()):
                is_wanted = attempt.verdict is Verdict.FAIL or not failures_only
                if attempt.decided is None or not is_wanted:
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
"""The instant recorded for a call that was interrupted before any sample was taken."""


def not_passed(verdicts: Mapping[str, Verdict]) -> Mapping[str, Verdict]:
    """The verdicts with everything that is not `F` turned into `I`."""
    return {name: fold([verdict], complete=False) for name, verdict in verdicts.items()}


def capped(report: Report, interrupted: int) -> Report:
    """The report of an interrupted run: every verdict but `F` is `I`, and health says why.

    `interrupted` is the instant that the run had reached, ticks.
    """
    first = None if interrupted == BEFORE_ALL else interrupted
    remark = "what followed was not evaluated in full"
    why = Health(HealthKind.INTERRUPTED, "monitor", 1, first, tuple(report.verdicts), remark)
    return replace(report, verdicts=not_passed(report.verdicts), health=(why, *report.health))


P = ParamSpec("P")
R = TypeVar("R")


class OneCall:
    """Runs calls one at a time; a call during another one, from any thread, is refused.

    Args:
        core: the run of the core, which also refuses samples during a call.

    Attributes:
        began: the instant of the run's first sample, ticks, as of the start of the latest call;
            `None` if there was none.
        reached: the instant that the run had reached then, ticks.
        interrupted: the instant reached when a call was first interrupted or failed; `None` if
            none was.
    """

    def __init__(self, core: native.Monitor) -> None:
        self._core = core
        self._turn: dict[None, object] = {}
        self._harmless: BaseException | None = None
        self.interrupted: int | None = None
        self.note_times()

    def note_times(self) -> None:
        """Update `began` and `reached`."""
        self.began, _, self.reached = self._core.times()

    def __call__(self, call: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
        """Run `call` exclusively.

        Raises:
            OverlapError: another call is in progress.
        """
        # KeyboardInterrupt can be raised wherever a function is called. So the turn is taken by a
        # single call (`setdefault`) inside the `try`, and checked and released without any call.
        token = object()
        try:
            if self._turn.setdefault(None, token) is not token or not self._core.hold(True):
                raise overlap()
            try:
                self.note_times()
                return call(*args, **kwargs)
            finally:
                self._core.hold(False)
        except RvmonError:
            raise
        except BaseException as error:
            # No function is called before this assignment, so no second interrupt can prevent it.
            if self.interrupted is None and error is not self._harmless:
                self.interrupted = BEFORE_ALL if self.reached is None else self.reached
            raise
        finally:
            self._harmless = None
            # Not `get`: another thread may release its turn between two lookups.
            try:
                if self._turn[None] is token:
                    del self._turn[None]
            except KeyError:
                pass

    def unchanging(self, call: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> R:
        """Run a part of the current call that changes no state: its failure is no interruption."""
        try:
            return call(*args, **kwargs)
        except BaseException as error:
            self._harmless = error
            raise


def overlap() -> OverlapError:
    """The error for a call during another one."""
    return OverlapError(
        "another call of this monitor is running, in another thread or in the code that a signal "
        "handler interrupted; this call was rejected: give each thread its own monitor, or hold "
        "a lock around the calls"
    )
