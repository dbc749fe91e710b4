"""When attempts start (SEMANTICS 3)."""

from __future__ import annotations

from rvmon.formula.state import FALSE, TRUE, UNKNOWN


class Trigger:
    """Follows the truth of a trigger from position to position.

    Args:
        pulse: whether it starts an attempt at every position where it holds.
        episodic: whether an attempt is an episode, of which one runs at a time.
    """

    __slots__ = ("before", "episodic", "known", "pulse", "running")

    def __init__(self, pulse: bool, episodic: bool) -> None:
        self.pulse = pulse
        self.episodic = episodic
        self.before = UNKNOWN
        self.known = False
        self.running = False

    def starts(self, truth: int) -> bool:
        """Whether an attempt starts at the next position, where the trigger has this truth.

        To be called at least where the truth changes, and at each position of a pulse that holds.
        """
        start = truth == TRUE and (self.pulse or self.before == FALSE or not self.known)
        self.before = truth
        self.known = self.known or truth != UNKNOWN
        if not self.episodic:
            return start
        if self.running:
            self.running = truth != FALSE
            return False
        self.running = start
        return start

    @property
    def repeats(self) -> bool:
        """Whether another attempt starts at the next position if the truth stays."""
        return self.pulse and not self.running and self.before == TRUE
