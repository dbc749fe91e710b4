"""One reading of the robot's sensors."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Reading:
    """What the three sensors say; `None`: this one has nothing to say yet."""

    gaze: bool | None
    pressure: bool | None
    location: bool | None
