"""A task that came to no result, as its process was ended: data."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Ended:
    """How the process of a task was ended.

    Attributes:
        timed_out: whether that was done here, as the task took too long.
        why: for people.
        seconds: wall time that the task had taken.
    """

    timed_out: bool
    why: str
    seconds: float
