"""When attempts start (SEMANTICS 3)."""

from __future__ import annotations

from rvmon.formula.state import FALSE, TRUE, UNKNOWN


class Trigger:
    """Follows the truth of a trigger from position to position.

    Args:
        pulse: whether it starts an attempt at every position where it holds.
        episodic: whether an attempt is an episode, of which one runs at a time.
        hidden: whether an episode starts only where the truth is unknown.
    """

    __slots__ = ("before", "episodic", "hidden", "pulse", "running")

    STATE = ("before", "running")

    def __init__(self, pulse: bool, episodic: bool, hidden: bool = False) -> None:
        self.pulse = pulse
        self.episodic = episodic
        self.hidden = hidden
        self.before = FALSE
        self.running = False

    def starts(self, truth: int) -> bool:
        """Whether an attempt starts at the next position, where the trigger has this truth.

        To be called at least where the truth changes, and at each position of a pulse that holds.
        """
        before, self.before = self.before, truth
        if not self.episodic:
            return truth == TRUE and (self.pulse or before == FALSE)
        if self.running:
            self.running = truth != FALSE
            return False
        self.running = truth == UNKNOWN if self.hidden else truth != FALSE
        return self.running

    @property
    def repeats(self) -> bool:
        """Whether another attempt starts at the next position if the truth stays."""
        if not self.episodic:
            return self.pulse and self.before == TRUE
        wanted = self.before == UNKNOWN if self.hidden else self.before != FALSE
        return wanted and not self.running
