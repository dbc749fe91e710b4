"""A way to compare ours with something independent."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Found = tuple[Counter[str], list[str]]
"""What cases were made of, and one text for each disagreement."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """A way to compare."""

    about: str  # what is compared with what, in a line
    # given a seed, the settings and a range of numbers, what came of those cases; it may run in
    # another process
    judge: Callable[..., Found]
    unit: str  # what is counted by these numbers
    # dataclasses whose fields may be changed; handed to `judge` in this order
    settings: tuple[Any, ...] = ()
    part: int = 25  # so many numbers are judged at once
