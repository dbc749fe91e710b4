"""A way to compare ours with something independent."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Comparison:
    """A way to compare.

    Args:
        judge: given a `Campaign`, a seed, the settings and a range of numbers, adds what came of
            those cases; it may run in another process. What it compares is its docstring.
        unit: what is counted by these numbers.
        settings: dataclasses whose fields may be changed.
        part: so many numbers are judged at once.
    """

    def __init__(
        self, judge: Callable[..., None], unit: str, *settings: Any, part: int = 25
    ) -> None:
        text = (judge.__doc__ or "").rstrip(".")
        self.about = text if text[1:2].isupper() else text[:1].lower() + text[1:]
        self.judge, self.unit, self.settings, self.part = judge, unit, settings, part
