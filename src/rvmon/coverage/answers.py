"""What can be reported of coverage: data. Items and tests go by their places in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Goals:
    """What is wanted of each item.

    Attributes:
        goal: hits that it needs.
        wanted: whether it is to be hit, so that it counts.
        unreachable: whether it would be, if it could be hit.
        illegal: whether a hit is an error.
        group: the place of its group in the model.
    """

    goal: NDArray[np.int64]
    wanted: NDArray[np.bool_]
    unreachable: NDArray[np.bool_]
    illegal: NDArray[np.bool_]
    group: NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Totals:
    """What became of each item.

    Attributes:
        counts: hits in all.
        tests: that hit it.
        first: the first test that did, −1 if none.
        instants: of the first hit in that test, ticks, where that is known.
    """

    counts: NDArray[np.int64]
    tests: NDArray[np.int64]
    first: NDArray[np.int64]
    instants: NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Step:
    """What a test added to those before it.

    Attributes:
        entry: the test.
        added: the items that reached their goals with it.
        share: of the model that is covered with it, from 0 to 1.
    """

    entry: int
    added: Sequence[int]
    share: float


@dataclass(frozen=True, slots=True)
class VerdictChange:
    """A requirement that another verdict was found for by the same test.

    Attributes:
        test: its name.
        requirement: the requirement's id.
        before: the earlier verdict; `None`: it was not judged.
        after: the later one; `None` likewise.
    """

    test: str
    requirement: str
    before: Verdict | None
    after: Verdict | None


@dataclass(frozen=True, slots=True)
class Comparison:
    """What is different from an earlier campaign.

    Attributes:
        before: the share that was covered, from 0 to 1.
        after: the share that is.
        gained: items that are covered and were not, by group and name.
        lost: items that were covered and are not.
        illegal: illegal items that are hit and were not.
        dropped: items that were to be covered, and that there are no more.
        verdicts: that changed.
    """

    before: float
    after: float
    gained: Sequence[tuple[str, str]]
    lost: Sequence[tuple[str, str]]
    illegal: Sequence[tuple[str, str]]
    dropped: Sequence[tuple[str, str]]
    verdicts: Sequence[VerdictChange]
