"""Example timelines: data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Example:
    """A short run and what the law says of it.

    Attributes:
        samples: what arrives, in order.
        end: the instant at which it ends, ticks.
        verdicts: by requirement.
        attempts: those that were started.
    """

    samples: tuple[Sample, ...]
    end: int
    verdicts: Mapping[str, Verdict]
    attempts: Sequence[Attempt]


@dataclass(frozen=True, slots=True)
class Budget:
    """How long to look for examples.

    Attributes:
        runs: short runs that are judged at most.
        samples: in one run at most.
        step: between two samples where nothing else asks for an instant, ticks; `None`: one that is
            small beside the durations of the requirements.
    """

    runs: int = 4000
    samples: int = 6
    step: int | None = None


@dataclass(frozen=True, slots=True)
class Found:
    """What a search for examples brought.

    Attributes:
        examples: by what was looked for, those with the fewest samples, then the earliest end.
        runs: how many were judged.
        exhausted: whether nothing was left to try among the instants and values looked at.
    """

    examples: Mapping[str, Example]
    runs: int
    exhausted: bool
