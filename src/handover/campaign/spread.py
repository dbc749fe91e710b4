"""How far the legacy robot's counts vary with the seed of the campaign: kept, for the page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import msgspec

from rvmon.writing import write_whole

SPREAD_FILE = "spread.json"
"""Beside this module; `python -m benchmarks.table1_bands --seeds 10 --write` writes it."""


class Spread(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Counts over campaigns of 100 tests for each random strategy.

    Attributes:
        first: seed of the first campaign.
        last: seed of the last campaign.
        ranges: the least and the greatest count by strategy, requirement and verdict.
    """

    first: int
    last: int
    ranges: Mapping[str, Mapping[str, Mapping[str, tuple[int, int]]]]


def spread() -> Spread:
    """What was computed.

    >>> spread().ranges["model-based"]["R1"]["P"]
    (2, 3)
    """
    return msgspec.json.decode(_path().read_bytes(), type=Spread)


def write_spread(found: Spread) -> None:
    """Keep what was computed."""
    write_whole(_path(), msgspec.json.encode(found) + b"\n")


def spread_text() -> str:
    """The counts of passed tests that vary with the seed, in a sentence."""
    found = spread()
    parts = []
    for strategy, rows in found.ranges.items():
        cells = [(name, *row["P"]) for name, row in rows.items()]
        varying = [f"{name} {low}–{high}" for name, low, high in cells if low != high]
        if varying:
            parts.append(f"{strategy} {', '.join(varying)}")
    return (
        f"Over the seeds {found.first} to {found.last}, with 100 tests of each random strategy, P "
        f"varies: {'; '.join(parts)} (python -m benchmarks.table1_bands)."
    )


def _path() -> Path:
    return Path(__file__).with_name(SPREAD_FILE)
