"""One call at a time: a monitor has no room for two."""

from __future__ import annotations

from threading import Lock
from typing import Protocol

from rvmon.errors import OverlapError, RvmonError, SnapshotError


class Guarded(Protocol):
    """What is entered by one call at a time."""

    def _enter(self) -> None:
        """Begin a call."""

    def _leave(self) -> None:
        """End it, however it ends."""


class OneCall:
    """Refuses a call that comes while another is under way, from whatever thread.

    Args:
        guarded: what is called.

    Attributes:
        restored: whether its state came from outside, and so may fit no monitor after all.
    """

    def __init__(self, guarded: Guarded) -> None:
        self.restored = False
        self._guarded = guarded
        self._lock = Lock()

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            raise overlap()
        try:
            self._guarded._enter()
        except BaseException:
            self._lock.release()
            raise

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        try:
            self._guarded._leave()
        finally:
            self._lock.release()
        if self.restored and isinstance(error, Exception) and not isinstance(error, RvmonError):
            raise SnapshotError(
                "the snapshot that this monitor was made of was damaged: what it held fits no "
                "monitor; begin a new run"
            ) from error


def overlap() -> OverlapError:
    """The error of a call that comes while another is under way."""
    return OverlapError(
        "another call of this monitor is under way, in another thread or in what a signal handler "
        "has interrupted; this one was not taken: give each thread a monitor of its own "
        "(spec.monitor()), or hold a lock round the calls"
    )
