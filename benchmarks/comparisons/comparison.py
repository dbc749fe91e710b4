"""A way to compare ours with something independent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Comparison:
    """A way to compare."""

    about: str  # what is compared with what, in a line
    # given a `Campaign`, a seed, the settings and a range of numbers, adds what came of those
    # cases; it may run in another process
    judge: Callable[..., None]
    unit: str  # what is counted by these numbers
    # dataclasses whose fields may be changed; handed to `judge` in this order
    settings: tuple[Any, ...] = ()
    part: int = 25  # so many numbers are judged at once
