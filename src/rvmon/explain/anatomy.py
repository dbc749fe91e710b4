"""What an attempt's subformulas were over its window: data."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.explain.spans import Spans
from rvmon.verdict.attempt import Attempt


@dataclass(frozen=True, slots=True)
class Strand:
    """One subformula over the window.

    Attributes:
        depth: how deep it lies; 0 for what is owed.
        text: as in the spec.
        part: `trigger` or `owed`.
        true: the ticks of the window at which it is true.
        false: those at which it is false; at the others it is not known.
    """

    depth: int
    text: str
    part: str
    true: Spans
    false: Spans


@dataclass(frozen=True, slots=True)
class Anatomy:
    """An attempt taken apart.

    Attributes:
        attempt: its record.
        start: first tick of the window that is shown.
        end: its last tick.
        origin: from which people count seconds, ticks.
        late: when what it had awaited came after its deadline, ticks; `None` if it did not.
        strands: the trigger, then what is owed, each before its parts.
    """

    attempt: Attempt
    start: int
    end: int
    origin: int
    late: int | None
    strands: tuple[Strand, ...]
