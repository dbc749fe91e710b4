"""What is kept of a test, and all that a database holds: data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, ClassVar

from rvmon.coverage.model import Model
from rvmon.verdict import Verdict

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Ending(StrEnum):
    """How a test ended."""

    COMPLETED = "completed"
    CRASHED = "crashed"
    HUNG = "hung"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class TestRecord:
    """A test of a campaign and what became of it, without what it hit.

    Attributes:
        name: for people; several tests may have one name.
        campaign: that it is part of.
        strategy: that made it; empty if none did, as for a recording from the field.
        recording: path of what was recorded; empty if that was not kept.
        seed: that it can be played again with.
        system: what was tested, such as a robot and its version.
        verdicts: by requirement.
        ending: how it ended.
        error: what went wrong if it did not complete, in words.
        number: its place in the campaign; tests with the same one are in the order of `when`.
        seconds: that it took.
        when: it was recorded, ns since 1970 in UTC; `None`: when it is written.
        expected: requirements that were known to fail, each with the reason.
    """

    __test__: ClassVar[bool] = False  # to pytest, which goes by names

    name: str
    campaign: str = ""
    strategy: str = ""
    recording: str = ""
    seed: int | None = None
    system: str = ""
    verdicts: Mapping[str, Verdict] = field(default_factory=dict)
    ending: Ending = Ending.COMPLETED
    error: str = ""
    number: int = 0
    seconds: float = 0.0
    when: int | None = None
    expected: Mapping[str, str] = field(default_factory=dict)

    @property
    def failed(self) -> tuple[str, ...]:
        """The requirements that failed and were not known to."""
        return tuple(name for name in self._failed if name not in self.expected)

    @property
    def failed_as_expected(self) -> dict[str, str]:
        """The requirements that failed as they were known to, each with the reason."""
        return {name: self.expected[name] for name in self._failed if name in self.expected}

    @property
    def _failed(self) -> list[str]:
        return [name for name, verdict in self.verdicts.items() if verdict is Verdict.FAIL]


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """What a test hit, as columns in step.

    Attributes:
        items: that were hit, by their places in `Coverage.items`, ascending.
        counts: how often, at least once each.
        firsts: instants of the first hits in ticks; `UNKNOWN` where that is not known.
    """

    items: NDArray[np.int32]
    counts: NDArray[np.int64]
    firsts: NDArray[np.int64]


UNKNOWN = -(1 << 63)
"""In place of an instant that is not known: no instant is so early."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A test with what it hit.

    Attributes:
        digest: distinguishes tests by their content.
        record: the test.
        row: what it hit.
    """

    digest: str
    record: TestRecord
    row: Row


@dataclass(frozen=True, slots=True)
class Coverage:
    """All that a database holds.

    Attributes:
        model: what is to be covered.
        items: names of group and item, in the order of the model.
        entries: the tests, in the order of their campaigns.
        reasons: why an item is not covered, by group and item, in words.
        unreachable: why an item cannot be hit, likewise; it is no goal, and a hit is an error.
    """

    model: Model
    items: Sequence[tuple[str, str]]
    entries: Sequence[Entry]
    reasons: Mapping[tuple[str, str], Sequence[str]] = field(default_factory=dict)
    unreachable: Mapping[tuple[str, str], Sequence[str]] = field(default_factory=dict)

    @property
    def campaigns(self) -> list[str]:
        """The names of the campaigns, in order."""
        return list(dict.fromkeys(entry.record.campaign for entry in self.entries))
