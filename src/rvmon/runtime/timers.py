"""When nodes change, and signals become stale, by time alone."""

from __future__ import annotations

from heapq import heappop, heappush, heapreplace

from rvmon.runtime.values import NEVER


class Timers:
    """A queue of instants; entries that do not hold any more are found as they come up.

    Attributes:
        timers: instants, each with a node, or behind these a signal.
        wakes: per node, when it changes by itself.
        queued: per node, the instant at which `timers` has it next.
        stale_at: per signal, from when on it is stale.
        wake: before this instant, no sample coming, nothing happens; `LIMIT` at most.
    """

    __slots__ = ("queued", "stale_at", "timers", "wake", "wakes")

    NODES = 0

    timers: list[tuple[int, int]]
    wakes: list[int]
    queued: list[int]
    stale_at: list[int]
    wake: int

    def expire(self, signal: int, t: int) -> int:
        """Make a signal stale from `t` on; returns the leaves that read it."""
        raise NotImplementedError

    def set_stale(self, signal: int, t: int) -> None:
        """Note when a signal that is not awaited to be so will be stale."""
        heappush(self.timers, (t, self.NODES + signal))
        self.stale_at[signal] = t
        # The update may have changed no value: then nothing else has the timer seen to.
        self.wake = min(self.wake, t)

    def set_wake(self, place: int, t: int) -> None:
        """Note when a node changes by itself."""
        self.wakes[place] = t
        if t < self.queued[place]:
            self.queued[place] = t
            heappush(self.timers, (t, place))

    def ring(self, t: int) -> int:
        """The leaves and operators that time alone makes change at `t`."""
        dirty = 0
        timers, wakes, queued = self.timers, self.wakes, self.queued
        nodes = self.NODES
        while timers and timers[0][0] <= t:
            at, code = timers[0]
            if code < nodes:
                due = wakes[code]
                if due <= t:
                    heappop(timers)
                    wakes[code] = queued[code] = NEVER
                    dirty |= 1 << code
                elif queued[code] != at:
                    heappop(timers)
                elif due < NEVER:
                    heapreplace(timers, (due, code))
                    queued[code] = due
                else:
                    heappop(timers)
                    queued[code] = NEVER
                continue
            heappop(timers)
            signal = code - self.NODES
            actual = self.stale_at[signal]
            if actual <= t:
                self.stale_at[signal] = NEVER
                dirty |= self.expire(signal, actual)
            elif actual < NEVER:
                heappush(timers, (actual, code))
        return dirty

    def requeue(self, at: int, place: int) -> None:
        """Put the timer of a node, taken from the queue, where it belongs by now."""
        if self.queued[place] == at:
            actual = self.queued[place] = self.wakes[place]
            if actual < NEVER:
                heappush(self.timers, (actual, place))

    def next_timer(self) -> int:
        """The next instant at which a node or signal changes by itself."""
        timers = self.timers
        while timers:
            at, code = timers[0]
            if code < self.NODES:
                if self.wakes[code] == at:
                    return at
                heappop(timers)
                self.requeue(at, code)
            else:
                actual = self.stale_at[code - self.NODES]
                if actual == at:
                    return at
                heappop(timers)
                if actual < NEVER:
                    heappush(timers, (actual, code))
        return NEVER
