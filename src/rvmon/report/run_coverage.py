"""What runs hit of coverpoints and crosses, and what not, as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rvmon.spec.checked.goals import BinKind
from rvmon.verdict.covered import CoveredBin, CoveredGroup

SHOWN = 12
"""Bins or combinations of a kind that are named; the rest is counted."""


def together(several: Sequence[Sequence[CoveredGroup]]) -> list[CoveredGroup]:
    """What several runs by one specification hit; when first is not asked for any more."""
    return [
        replace(groups[0], bins=tuple(map(_sum, zip(*(one.bins for one in groups), strict=True))))
        for groups in zip(*several, strict=True)
    ]


def _sum(bins: Sequence[CoveredBin]) -> CoveredBin:
    return replace(bins[0], hits=sum(one.hits for one in bins), first=None)


def coverage_lines(groups: Sequence[CoveredGroup]) -> Iterator[str]:
    """How often each bin was hit, then what was hit too rarely; a line or two for each group.

    >>> low = CoveredBin("low", BinKind.GOAL, 1, 4)
    >>> high = CoveredBin("high", BinKind.GOAL, 3, 1)
    >>> for line in coverage_lines([CoveredGroup("size", "coverpoint", (low, high))]):
    ...     print(line)
    size: 1 of 2 covered; hit: low 4, high 1
    size: not covered: high (1 of 3)
    """
    for group in groups:
        wanted = [one for one in group.bins if one.kind is BinKind.GOAL]
        holes = [one for one in wanted if one.is_hole]
        hit = [f"{_name(one)} {one.hits:,}" for one in group.bins if one.hits]
        covered = f"{group.name}: {len(wanted) - len(holes):,} of {len(wanted):,} covered"
        yield f"{covered}; hit: {_listed(hit)}" if hit else covered
        if holes:
            yield f"{group.name}: not covered: {_listed([_missing(one) for one in holes])}"


def _name(one: CoveredBin) -> str:
    return one.name if one.kind is BinKind.GOAL else f"{one.name} ({one.kind})"


def _missing(one: CoveredBin) -> str:
    return one.name if one.goal == 1 else f"{one.name} ({one.hits:,} of {one.goal:,})"


def _listed(names: Sequence[str]) -> str:
    rest = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f", … and {rest:,} more" if rest > 0 else "")
