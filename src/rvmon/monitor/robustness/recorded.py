"""Figures of a whole recording out of what the core finds row by row."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.monitor.robustness.values import Key, Margins, Robustness, Stream

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FIGURES = ("low", "high", "kept")

MARGIN = np.dtype(
    [
        ("t", np.int64),
        *((name, np.float64) for name in _FIGURES),
        *(("requirement", np.int32), ("number", np.uint32)),
        *((name, np.uint8) for name in ("in_doubt", "of_position")),
    ],
    align=True,
)
"""`rv_margin` of `core.h`."""


class RecordedMargins:
    """The figures of a run.

    Args:
        ids: of requirements, by number.
    """

    def __init__(self, ids: Sequence[str]) -> None:
        self._ids = ids
        self._attempts: dict[Key, Robustness] = {}
        self._doubtful: dict[Key, Robustness] = {}
        self._parts: dict[int, list[Sequence[NDArray[Any]]]] = {}

    def add(self, found: bytes) -> None:
        """Take figures as bytes of `MARGIN`."""
        margins = np.frombuffer(found, MARGIN)
        of_position = margins["of_position"] == 1
        if not of_position.all():
            self._add_attempts(margins[~of_position])
            margins = margins[of_position]
        several = len(self._ids) > 1
        numbers = np.unique(margins["requirement"]).tolist() if several else [0]
        for number in numbers if len(margins) else ():
            own = margins[margins["requirement"] == number] if several else margins
            columns = [own[name].copy() for name in ("t", *_FIGURES)]
            self._parts.setdefault(number, []).append(columns)

    def _add_attempts(self, margins: NDArray[Any]) -> None:
        for _, low, high, kept, requirement, number, in_doubt, _ in margins.tolist():
            figures = self._doubtful if in_doubt else self._attempts
            figures[self._ids[requirement], number] = Robustness(low, high, kept)

    def margins(self) -> Margins:
        """All of them."""
        streams = {
            self._ids[number]: Stream(*map(np.concatenate, zip(*parts, strict=True)))
            for number, parts in self._parts.items()
        }
        return Margins(self._attempts, self._doubtful, streams)
