"""When the attempts of one requirement start, and what becomes of episodes."""

from __future__ import annotations

from typing import Any

from rvmon.runtime.values import FALSE, TRUE, UNKNOWN


class Starts:
    """Follows a trigger from position to position.

    Args:
        trigger: the node of its trigger; −1: the end of the trace.
        pulse: whether it starts an attempt at every position where its trigger holds.
        episodic: whether one attempt runs at a time, until the trigger is false.
        hidden: whether an episode starts only where the trigger is unknown.
        again: the node that is not false where an episode goes on after a failure; −1: none.
        unborn: the node that is true while something that is owed had no value; −1: none.
        values: the truth of the state formulas.
        clerk: makes attempts and hears of decisions.

    Attributes:
        attempts: the undecided ones, oldest first.
        running: whether an episode runs.
        current: the instant of the trigger of the attempt that runs in an episode, or `None`.
        failed_at: the instant at which that failed, the episode running on.
        clouded: whether the trigger was unknown while it ran.
        looking: whether it has to see the trigger before its attempts do.

    Source: SEMANTICS, sections 1 (Birth) and 3 (Doubt, After a failure).
    """

    __slots__ = (
        "again",
        "attempts",
        "before",
        "clerk",
        "clouded",
        "current",
        "episodic",
        "failed_at",
        "hidden",
        "looking",
        "pulse",
        "running",
        "trigger",
        "unborn",
        "values",
    )

    STATE: tuple[str, ...] = (
        *("attempts", "before", "running", "current", "failed_at", "clouded", "looking"),
    )

    def __init__(
        self,
        trigger: int,
        pulse: bool,
        episodic: bool,
        hidden: bool,
        again: int,
        unborn: int,
        values: list[int],
        clerk: Any,
    ) -> None:
        self.trigger = trigger
        self.pulse = pulse
        self.episodic = episodic
        self.hidden = hidden
        self.again = again
        self.unborn = unborn
        self.values = values
        self.clerk = clerk
        self.attempts: list[Any] = []
        self.before = FALSE
        self.running = False
        self.current: int | None = None
        self.failed_at: int | None = None
        self.clouded = False
        self.looking = False

    def starts(self, truth: int) -> bool:
        """Whether an attempt starts at a position where the trigger has this truth.

        To be called at least where the truth changes, and at each position of a pulse that holds.
        """
        before, self.before = self.before, truth
        if not self.episodic:
            return truth == TRUE and (self.pulse or before == FALSE)
        if not self.running:
            self.running = truth == UNKNOWN if self.hidden else truth != FALSE
            return self.running
        if truth == FALSE:
            self.running = False
            self.current = self.failed_at = None
        elif truth == UNKNOWN:
            self.clouded = True
        return False

    @property
    def repeats(self) -> bool:
        """Whether another attempt starts at the next position if the trigger stays."""
        if not self.episodic:
            return self.pulse and self.before == TRUE
        wanted = self.before == UNKNOWN if self.hidden else self.before != FALSE
        return wanted and not self.running

    @property
    def is_sure(self) -> bool:
        """Whether an attempt that starts here has a trigger that is true."""
        return not self.episodic or bool(self.values[self.trigger] == TRUE)

    @property
    def is_unborn(self) -> bool:
        """Whether something that is owed speaks of signals that have had no value."""
        return self.unborn >= 0 and self.values[self.unborn] == TRUE

    @property
    def is_plain(self) -> bool:
        """Whether an attempt that starts here is sure, and no signal is to be waited for."""
        values = self.values
        return not self.episodic or (
            not self.hidden
            and values[self.trigger] == TRUE
            and (self.unborn < 0 or values[self.unborn] != TRUE)
        )

    @property
    def running_attempt(self) -> Any:
        """The attempt of an episode that runs, unless it stands in `runs`."""
        return next((one for one in self.attempts if one.triggered == self.current), None)

    def enter(self, triggered: int, *, plain: bool) -> None:
        """Take it that an attempt runs from here on; `plain`: see `is_plain`."""
        if self.episodic:
            self.running = True
            self.current = triggered
            self.failed_at = None
            self.clouded = not plain and self.values[self.trigger] == UNKNOWN
            self.looking = not (self.hidden or plain)

    def look(self) -> None:
        """See the trigger before the attempts do: it may make one sure, or void."""
        attempt = self.running_attempt
        if attempt is None:
            return
        if self.values[self.trigger] == FALSE:
            attempt.void = attempt.void or self.is_unborn
        elif not attempt.sure and self.is_sure:
            attempt.sure = True
            self.clerk.assured(self, attempt)

    def fail(self, triggered: int, t: int) -> None:
        """Note that an attempt has failed at `t`."""
        if triggered == self.current and self.again >= 0:
            self.current = None
            self.failed_at = t

    @property
    def goes_on(self) -> bool:
        """Whether what is owed has not failed at once at the position that the values are of."""
        return bool(self.values[self.again] != FALSE)

    def settle_flags(self) -> None:
        """Come to the end: what runs may be over, or void; what is over is neither."""
        attempt = self.running_attempt
        if attempt is not None:
            attempt.clouded = self.clouded
            attempt.void = attempt.void or self.is_unborn
