"""One call at a time: a monitor has no room for two, and tells of one that was interrupted."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import ParamSpec, Protocol, TypeVar

from rvmon.errors import OverlapError, RvmonError
from rvmon.trace.health import Health, HealthKind
from rvmon.trace.time import TIME_LIMIT
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict, fold

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


class Guarded(Protocol):
    """What is entered by one call at a time.

    Attributes:
        _reached: how far its run has come, ticks.
        _interrupted: how far it had come when a call was interrupted or failed; `None`: none was.
    """

    _reached: int | None
    _interrupted: int | None

    def _enter(self) -> None:
        """Begin a call."""

    def _leave(self) -> None:
        """End it, however it ends."""


class OneCall:
    """Refuses a call that comes while another is under way, from whatever thread."""

    def __init__(self, guarded: Guarded) -> None:
        self._guarded = guarded
        self._turn: dict[None, object] = {}
        self._spared: BaseException | None = None

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
            if self._turn.setdefault(None, own) is not own:
                raise overlap()
            self._guarded._enter()
            try:
                return call(*args, **kwargs)
            finally:
                self._guarded._leave()
        except RvmonError:
            raise
        except BaseException as error:
            # No function is called up to the mark: another interrupt cannot come before it.
            if self._guarded._interrupted is None and error is not self._spared:
                reached = self._guarded._reached
                self._guarded._interrupted = BEFORE_ALL if reached is None else reached
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
        "has interrupted; this one was not taken: give each thread a monitor of its own "
        "(spec.monitor()), or hold a lock round the calls"
    )
