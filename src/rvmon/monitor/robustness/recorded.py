"""Figures of a whole recording out of what the core has found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rvmon.monitor.robustness.values import Key, Margins, Robustness, Stream

MARGIN = np.dtype(
    [
        ("t", np.int64),
        *((name, np.float64) for name in ("low", "high", "kept")),
        *(("requirement", np.int32), ("number", np.uint32)),
        *((name, np.uint8) for name in ("in_doubt", "of_position")),
    ],
    align=True,
)
"""`rv_margin` of `core.h`."""


def recorded_margins(ids: Sequence[str], found: bytes) -> Margins:
    """The figures of a run.

    Args:
        ids: of requirements, by number.
        found: all of the run, as bytes of `MARGIN`.
    """
    margins = np.frombuffer(found, MARGIN)
    of_position = margins["of_position"] == 1
    attempts: dict[Key, Robustness] = {}
    doubtful: dict[Key, Robustness] = {}
    for one in margins[~of_position].tolist():
        _, low, high, kept, requirement, number, in_doubt, _ = one
        figures = doubtful if in_doubt else attempts
        figures[ids[requirement], number] = Robustness(low, high, kept)
    positions = margins if of_position.all() else margins[of_position]
    streams = {}
    for requirement in np.unique(positions["requirement"]).tolist():
        own = positions
        if len(ids) > 1:
            own = positions[positions["requirement"] == requirement]
        columns = (np.ascontiguousarray(own[name]) for name in ("t", "low", "high", "kept"))
        streams[ids[requirement]] = Stream(*columns)
    return Margins(attempts, doubtful, streams)
