"""The attempts of a `whenever`, one after the other: each failure begins another (SEMANTICS 3)."""

from __future__ import annotations

from collections.abc import Callable

from rvmon.dataflow.flow import Flow
from rvmon.formula.state import FALSE, TRUE, UNKNOWN, State
from rvmon.monitor.attempt_judge import AttemptJudge, Open


class Episode:
    """Follows the episodes of a requirement in a lane.

    Args:
        judge: of the attempts.
        flow: that the judge reads.
        doubted: whether it is not known that there is such an instance.
        start: takes an attempt that has begun where the trigger was not TRUE.
        sure: hears of an attempt whose trigger was TRUE for the first time.

    Attributes:
        place: of what is FALSE in the flow where the episode is over.
        again: of the formula that is FALSE where what is owed fails at once; −1: it does not go on.
        current: the attempt that runs, or has failed in an episode that runs.
        failed_at: the instant of that failure.
        resume: is told when that is.

    Source: SEMANTICS, sections 1 (Birth) and 3 (Doubt, After a failure).
    """

    STATE = ("current", "failed_at")

    def __init__(
        self,
        judge: AttemptJudge,
        flow: Flow,
        *,
        doubted: bool,
        start: Callable[[Open], None],
        sure: Callable[[Open, int], None],
    ) -> None:
        self.judge = judge
        self._flow = flow
        self._doubted = doubted
        judge.episode = self
        self._start = start
        self._sure = sure
        obligation = judge.compiled.obligation
        self.place = self._place_of(obligation.running)
        self._trigger = self._place_of(obligation.trigger)
        self.again = self._place_of(obligation.again)
        self._unborn = self._place_of(obligation.unborn)
        self.current: Open | None = None
        self.failed_at: int | None = None
        self.resume: Callable[[Episode], None] = _ignore

    def _place_of(self, state: State | None) -> int:
        return -1 if state is None else self._flow.graph.index[state]

    @property
    def is_running(self) -> bool:
        """Whether an episode runs: it may go on."""
        return self.current is not None

    def begin(self, t: int, triggered: int) -> Open:
        """Start an attempt at the position `t`, which the flow is at."""
        value = self._flow.values[self._trigger]
        attempt = self.judge.new_attempt(t, triggered)
        attempt.void = self._flow.is_cut
        self.current, self.failed_at = attempt, None
        if value != TRUE or self._doubted:
            self._start(attempt)
        self._see(attempt, value, t)
        self.judge.begin(attempt, t)
        return attempt

    def fail(self, attempt: Open, t: int) -> None:
        """Hear that an attempt has failed at `t`."""
        if attempt is self.current:
            self.failed_at = t
            if self.again >= 0:
                self.resume(self)

    def look(self, t: int) -> None:
        """See the trigger, at the position `t`, before the attempts do."""
        attempt = self.current
        if attempt is None:
            return
        value = self._flow.values[self.place]
        if value == FALSE:
            attempt.void = attempt.void or self.is_unborn
            self.current = self.failed_at = None
        elif self.failed_at is None:
            self._see(attempt, value, t)

    def _see(self, attempt: Open, value: int, t: int) -> None:
        if value == UNKNOWN:
            attempt.clouded = True
        elif value == TRUE and not attempt.sure and not self._doubted:
            attempt.sure = True
            self._sure(attempt, t)

    def close(self) -> None:
        """Come to the end: what runs may be over, or void; what is over is neither."""
        for attempt in self.judge.attempts:
            if attempt is self.current:
                attempt.void = attempt.void or self.is_unborn
            elif not self._flow.is_cut:
                attempt.clouded = False

    @property
    def is_unborn(self) -> bool:
        """Whether something that is owed speaks of signals that have had no value."""
        return self._unborn >= 0 and self._flow.values[self._unborn] == TRUE

    def goes_on(self, t: int) -> bool:
        """Whether a failed attempt is followed by another at the position `t`."""
        return self.failed_at is not None and t > self.failed_at and self.may_go_on

    @property
    def may_go_on(self) -> bool:
        """Whether what is owed has not failed at once at the position that the flow is at."""
        return self.again >= 0 and self._flow.values[self.again] != FALSE


def _ignore(_: Episode) -> None:
    """Nobody goes on."""
