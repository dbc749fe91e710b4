"""Live monitors in an event loop."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from rvmon.live.driver import Driver

if TYPE_CHECKING:
    from rvmon.session import Spec


class LiveTasks(Driver):
    r"""A driver that the running event loop drives, within `async with`.

    Callbacks are called in the loop. `offer` may be called from any thread.

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
