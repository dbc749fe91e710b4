"""Drivers that run themselves: in their own thread, or in an event loop."""

from __future__ import annotations

import asyncio
from threading import Condition, Thread, current_thread
from typing import TYPE_CHECKING, Any

from rvmon.live.driver import Driver

if TYPE_CHECKING:
    from rvmon.session import Spec
    from rvmon.verdicts.report import Report


class Live(Driver):
    r"""A driver with its own thread, from `with` or `start` to `close`.

    Args:
        spec: as for `Driver`.
        **options: as for `Driver`.

    >>> from rvmon import loads
    >>> from rvmon.live import Live
    >>> spec = loads("spec s\nsignal x : real\nrequirement R\n  always x < 3\n")
    >>> with Live(spec) as live:
    ...     _ = live.offer({"x": 5.0})
    >>> live.close()[""][0].verdicts["R"]
    <Verdict.FAIL: 'F'>
    """

    def __init__(self, spec: Spec, **options: Any) -> None:
        super().__init__(spec, **options)
        self._changed = Condition()
        self._is_called = False
        self._stops = False
        self._thread: Thread | None = None
        self.wake = self._wake

    def start(self) -> Live:
        """Start the thread; idempotent."""
        if self._thread is None:
            self._thread = Thread(target=self._drive, name="rvmon.live", daemon=True)
            self._thread.start()
        return self

    def _wake(self) -> None:
        with self._changed:
            self._is_called = True
            self._changed.notify()

    def _drive(self) -> None:
        while True:
            seconds = self.work()
            with self._changed:
                if not self._is_called and not self._stops and seconds != 0:
                    self._changed.wait(seconds)
                self._is_called = False
                if self._stops:
                    return

    def close(self) -> dict[str, tuple[Report, ...]]:
        """Close the driver, as `Driver.close` does, and join the thread."""
        # In a callback, the thread cannot join itself; `Driver.close` refuses that call.
        if current_thread() is not self._thread:
            with self._changed:
                self._stops = True
                self._changed.notify()
            if self._thread is not None:
                self._thread.join()
        return super().close()

    def __enter__(self) -> Live:
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.close()


class LiveTasks(Driver):
    r"""A driver that runs in the current event loop, within `async with`.

    Callbacks are called in the loop; `offer` may be called from any thread.

    Args:
        spec: as for `Driver`.
        **options: as for `Driver`.

    >>> import asyncio
    >>> from rvmon import loads
    >>> from rvmon.live import LiveTasks
    >>> spec = loads("spec s\nsignal x : real\nrequirement R\n  always x < 3\n")
    >>> async def main():
    ...     async with LiveTasks(spec) as live:
    ...         live.offer({"x": 5.0})
    ...     return live.close()[""][0].verdicts["R"]
    >>> asyncio.run(main())
    <Verdict.FAIL: 'F'>
    """

    def __init__(self, spec: Spec, **options: Any) -> None:
        super().__init__(spec, **options)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._timer: asyncio.Handle | None = None

    async def __aenter__(self) -> LiveTasks:
        self._loop = asyncio.get_running_loop()
        self.wake = lambda: self._loop and self._loop.call_soon_threadsafe(self._drive)
        self._drive()
        return self

    def _drive(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self._loop is not None and (seconds := self.work()) is not None:
            self._timer = self._loop.call_later(seconds, self._drive)

    async def __aexit__(self, *_: object) -> None:
        self._loop = None
        if self._timer is not None:
            self._timer.cancel()
        self.close()
